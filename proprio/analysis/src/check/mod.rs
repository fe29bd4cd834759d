//! `proprio check`: faults of a session, found in one pass over its rows, in memory that does not grow with their number.
//!
//! The thresholds were chosen on simulated arms 1 to 12 and 30 (`proprio simulate --arm-seed`, each with a table calibrated on a
//! sweep of its own) in scenarios 1 to 3 and all motions that begin with a straight arm at rest, and judged on arms 21 to 29. That
//! of `twins.rs` was raised once after a look at sessions of another simulator.
//!
//! | file | rule |
//! |---|---|
//! | `finding.rs` | findings: source, rows, kind, figure |
//! | `frame.rs` | the readings of a row as angles |
//! | `clock.rs` | unit of the times, equal times, gaps |
//! | `tare.rs` | a tare that is bent or moves |
//! | `bend_range.rs` | bend readings outside the voltages of the map |
//! | `frozen.rs` | values that are repeated while other sensors move |
//! | `same_imus.rs` | two IMUs with the same readings |
//! | `new_zero.rs` | IMUs that continue from another zero, or read 0 |
//! | `steps.rs` | steps of the IMUs against those of the bend sensors |
//! | `truth/` | the truth by itself, against the lengths and against the sensors' clock |
//! | `twins.rs` | a bend sensor that leaves its twin and the IMU |

mod bend_range;
mod clock;
mod finding;
mod frame;
mod frozen;
mod new_zero;
mod same_imus;
mod steps;
mod tare;
pub mod truth;
mod twins;

use std::path::Path;

use proprio_session::{LoadedTable, Progress, Row};

pub use finding::{Finding, Kind, Rows, Source};

use self::bend_range::BendRange;
use self::clock::Clock;
use self::frame::Decoder;
use self::frozen::Frozen;
use self::new_zero::NewZero;
use self::same_imus::SameImus;
use self::steps::Steps;
use self::tare::Tare;
use self::truth::{TruthCheck, TruthRow};
use self::twins::Twins;
use crate::error::Error;
use crate::replay::{SessionRows, SessionSummary};

/// A check of one session, row by row.
pub struct SessionCheck {
    decoder: Decoder,
    clock: Clock,
    tare: Tare,
    bend_range: BendRange,
    frozen: Frozen,
    same_imus: SameImus,
    new_zero: NewZero,
    steps: Steps,
    twins: Twins,
    truth: TruthCheck,
}

impl SessionCheck {
    /// A check before the first row.
    ///
    /// # Errors
    /// [`Error::File`] on an arm description.
    pub fn new(table: &LoadedTable) -> Result<Self, Error> {
        let decoder = Decoder::new(table)?;
        let segments = table.file.segments.len();
        Ok(Self {
            decoder,
            clock: Clock::new(table.file.rate_hz),
            tare: Tare::new(&table.file),
            bend_range: BendRange::new(&table.file),
            frozen: Frozen::new(segments),
            same_imus: SameImus::new(segments),
            new_zero: NewZero::new(),
            steps: Steps::new(segments),
            twins: Twins::new(&table.file),
            truth: TruthCheck::new(&table.file),
        })
    }

    /// Checks the next row.
    pub fn update(&mut self, row: &Row) {
        self.decoder.update(row);
        let frame = &self.decoder.frame;
        self.clock.update(frame);
        self.tare.update(frame);
        self.bend_range.update(frame);
        self.frozen.update(frame);
        self.same_imus.update(frame);
        self.new_zero.update(frame);
        self.steps.update(frame);
        self.twins.update(frame);
        self.truth.update(&TruthRow::of(row, frame.row));
    }

    /// The findings, after the last row.
    #[must_use]
    pub fn finish(mut self) -> Vec<Finding> {
        let mut findings = Vec::new();
        // The other rules take times for seconds.
        if !self.clock.finish(&mut findings) {
            return findings;
        }
        // A rule leaves out the sensors that an earlier one has found.
        self.bend_range.finish(&mut findings);
        self.frozen.finish(&mut findings);
        self.same_imus.finish(&mut findings);
        self.steps.finish(&mut findings);
        self.new_zero.finish(&mut findings);
        self.tare.finish(&mut findings);
        self.twins.finish(&mut findings);
        findings.extend(self.truth.finish().0.findings);
        findings
    }
}

/// Checks a session.
///
/// # Errors
/// Errors of the session and the table.
pub fn check(
    session: &Path,
    table: &LoadedTable,
    progress: &mut dyn Progress,
) -> Result<(SessionSummary, Vec<Finding>), Error> {
    let mut check = SessionCheck::new(table)?;
    let mut rows = SessionRows::open(session, table, "checking", progress)?;
    while let Some(row) = rows.next_row()? {
        check.update(&row);
    }
    Ok((rows.summary(table)?, check.finish()))
}
