//! Faults of a session of a soft robot arm, found in one pass over its rows, in memory that does not grow with their number.
//!
//! The thresholds were chosen on simulated arms 1 to 12 and 30 (`proprio simulate --arm-seed`, each with a table calibrated on a
//! sweep of its own) in scenarios 1 to 3 and all motions that begin with a straight arm at rest, and judged on arms 21 to 29. That
//! of `twins.rs` was raised once after a look at sessions of another simulator. Those of `held.rs`, `common_zero.rs` and
//! `steps/exchanges.rs` were chosen on arms 1 to 8, and judged on arms 501 to 506; that of a common turn was raised once after arm
//! 502. Those of `drift.rs`, `counts_scale.rs`, of repeats that are no chance and of few swings were chosen on arms 1 to 8, and
//! judged on arms 601 to 614.
//!
//! | file | rule |
//! |---|---|
//! | `finding.rs` | findings: source, rows, kind, figure |
//! | `source.rs`, `rows.rs`, `kind.rs`, `text.rs` | the parts of a finding, and its text |
//! | `frame.rs` | the readings of a row as angles |
//! | `clock.rs` | unit of the times, equal times, gaps |
//! | `tare.rs` | a tare that is bent or moves |
//! | `bend_range.rs` | bend readings outside the voltages of the map |
//! | `plugs.rs` | exchanged plugs of bend sensors, counts of another ADC |
//! | `frozen.rs` | values that are repeated while other sensors move |
//! | `held.rs` | readings that are repeated and then catch up |
//! | `same_imus.rs` | two IMUs with the same readings |
//! | `common_zero.rs` | all IMUs that return from a gap with one turn |
//! | `new_zero.rs` | IMUs that continue from another zero, or read 0 |
//! | `steps/` | steps of the IMUs against those of the bend sensors |
//! | `quaternions.rs` | quaternions in another order, IMUs on their side |
//! | `truth/` | the truth by itself, against the lengths and against the sensors' clock |
//! | `clock_fit/` | the camera's clock against the sensors', by their motion |
//! | `drift.rs` | drift of an IMU, or of both bend sensors of a segment |
//! | `counts_scale.rs` | counts of an ADC whose reference is off by some percent |
//! | `twins.rs` | a bend sensor that leaves its twin and the IMU |

mod bend_range;
mod clock;
pub mod clock_fit;
mod common_zero;
mod counts_scale;
mod drift;
mod finding;
mod frame;
mod frozen;
mod held;
mod kind;
mod median;
mod new_zero;
mod plugs;
mod quaternions;
mod rows;
mod same_imus;
mod source;
mod steps;
mod tare;
mod text;
pub mod truth;
mod twins;

use std::path::Path;

use calibration_tables::ArmFile;
use proprio_session::{Error, FileDefects, LoadedTable, MissingHistory, Progress, RequiredColumns, Row, SessionReader};

pub use finding::{Finding, Kind, Rows, Source};
pub use tare::TARE_MOVES_DEG;

use self::bend_range::BendRange;
use self::clock::Clock;
use self::common_zero::CommonZero;
use self::drift::Drift;
use self::frame::Decoder;
use self::frozen::Frozen;
use self::held::Held;
use self::new_zero::NewZero;
use self::plugs::Plugs;
use self::same_imus::SameImus;
use self::steps::Steps;
use self::tare::Tare;
use self::truth::{TruthCheck, TruthRow};
use self::twins::Twins;

/// A check of one session, row by row.
pub struct SessionCheck {
    arm: ArmFile,
    decoder: Decoder,
    /// The rules before the first row.
    start: Rules,
    rules: Rules,
}

/// The rules, each with what it has seen so far.
#[derive(Debug, Clone)]
struct Rules {
    clock: Clock,
    tare: Tare,
    bend_range: BendRange,
    frozen: Frozen,
    held: Held,
    same_imus: SameImus,
    common_zero: CommonZero,
    new_zero: NewZero,
    steps: Steps,
    twins: Twins,
    drift: Drift,
    truth: TruthCheck,
}

impl SessionCheck {
    /// A check before the first row, with a table; with an arm description, by the rules that need no map: times, tare, IMUs that
    /// never change, and IMUs with the same readings.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn new(table: &LoadedTable) -> Result<Self, Error> {
        let decoder = Decoder::new(table)?;
        let segments = table.file.segments.len();
        let rules = Rules {
            clock: Clock::new(table.file.rate_hz),
            tare: Tare::new(&table.file),
            bend_range: BendRange::new(&table.file),
            frozen: Frozen::new(segments, decoder.has_maps()),
            held: Held::new(),
            same_imus: SameImus::new(segments),
            common_zero: CommonZero::new(segments),
            new_zero: NewZero::new(),
            steps: Steps::new(segments, Plugs::new(&table.file, &decoder)),
            twins: Twins::new(&table.file),
            drift: Drift::new(&table.file),
            truth: TruthCheck::new(&table.file),
        };
        Ok(Self { arm: table.file.clone(), decoder, start: rules.clone(), rules })
    }

    /// Starts again before the next row, which becomes row 1.
    pub fn restart(&mut self) {
        self.decoder.frame.row = 0;
        self.rules = self.start.clone();
    }

    /// Checks the next row.
    pub fn update(&mut self, row: &Row) {
        self.decoder.update(row);
        let (frame, rules) = (&self.decoder.frame, &mut self.rules);
        rules.clock.update(frame);
        rules.tare.update(frame);
        rules.bend_range.update(frame);
        rules.frozen.update(frame);
        rules.held.update(frame);
        rules.same_imus.update(frame);
        rules.common_zero.update(frame);
        rules.new_zero.update(frame);
        rules.steps.update(frame);
        rules.twins.update(frame);
        rules.drift.update(frame);
        if row.truth.iter().any(Option::is_some) {
            rules.truth.update(&TruthRow::new(row, frame.row, &frame.headings));
        }
    }

    /// The findings in the rows so far.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        self.rules.clone().finish(&self.arm)
    }
}

impl Rules {
    fn finish(mut self, arm: &ArmFile) -> Vec<Finding> {
        let mut findings = Vec::new();
        // The other rules take times for seconds.
        if !self.clock.finish(&mut findings) {
            return findings;
        }
        // A rule leaves out the sensors that an earlier one has found.
        self.frozen.finish(&mut findings);
        self.same_imus.finish(&mut findings);
        self.steps.plugs.finish(&mut findings);
        self.bend_range.finish(&mut findings);
        self.steps.finish(&mut findings);
        self.held.finish(&mut findings);
        self.new_zero.finish(&mut findings);
        self.common_zero.finish(&mut findings);
        self.tare.finish(&mut findings);
        self.twins.finish(&mut findings);
        self.drift.finish(&mut findings);
        counts_scale::finish(arm, &self.steps.plugs, &mut findings);
        let is_held = findings.iter().any(|finding| finding.kind == Kind::Held);
        let mut of_truth = self.truth.finish().0.findings;
        // It is the repeats that are late.
        of_truth.retain(|finding| !is_held || finding.kind != Kind::TruthLag);
        findings.append(&mut of_truth);
        findings
    }
}

/// A session that was checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedSession {
    /// Number of rows.
    pub samples: u64,
    /// The rows of a recording that have another tare than on the board.
    pub missing_history: MissingHistory,
    /// The file's defects, past which it was read.
    pub defects: FileDefects,
    /// The findings.
    pub findings: Vec<Finding>,
}

/// Checks a session with a table, or with an arm description as [`SessionCheck::new`] says.
///
/// # Errors
/// Errors of the session and the table.
pub fn check(session: &Path, table: &LoadedTable, progress: &mut dyn Progress) -> Result<CheckedSession, Error> {
    let mut check = SessionCheck::new(table)?;
    let needs = if check.decoder.has_maps() {
        table.required_columns()?
    } else {
        RequiredColumns { truth: false, ..RequiredColumns::of_calibration(&table.file) }
    };
    let mut reader = SessionReader::open(session, &needs)?;
    let work = format!("checking {}", session.display());
    let mut missing_history = MissingHistory::default();
    while let Some(row) = reader.next_row()? {
        if row.is_recorded() {
            check.update(&row);
            missing_history.add(&row);
        }
        progress.advance(&work, reader.progress());
    }
    let (samples, defects) = (missing_history.rows, reader.defects());
    Ok(CheckedSession { samples, missing_history, defects, findings: check.findings() })
}
