//! The truth by itself, against the table's lengths, and against the sensors' clock.
//!
//! The thresholds were chosen on simulated arms 31 to 37, and judged on arms 41 to 52.
//!
//! | file | purpose |
//! |---|---|
//! | `row.rs` | the truth of a row |
//! | `links.rs` | the chain of the true poses |
//! | `fault.rs` | wrong poses |
//! | `holds.rs` | poses that are repeated while the arm moves |
//! | `usual.rs` | scale and residuals of the first rows |
//! | `judge.rs` | wrong poses, row by row |
//! | `pieces.rs` | scale, unit and lag, as medians over pieces of the session |
//! | `tally.rs` | findings of the wrong poses |
//! | `left_out.rs` | the poses that are left out |

mod fault;
mod holds;
mod judge;
mod left_out;
mod links;
mod pieces;
mod row;
mod tally;
mod usual;

use calibration_tables::ArmFile;

pub use fault::{Fault, FaultKind};
pub use left_out::LeftOut;
pub use links::geometry;
pub use row::TruthRow;

use self::judge::{Judge, LinkedRow};
use self::pieces::{Pieces, Values};
use self::tally::Tally;
use super::finding::{Finding, Kind, Source};

/// Difference of the truth's lengths from the table's above which there is a finding, as a share.
const LENGTHS: f64 = 0.02;
/// Lag above which there is a finding, s.
const LAG_S: f64 = 0.03;
/// Scales of other units over that of the column, and the tolerance of all such factors.
const UNITS: [f64; 3] = [0.001, 0.1, 1000.0];
const TOLERANCE: f64 = 0.15;
/// Directions by the places over those by the headings, of the same axes.
const TURN: std::ops::RangeInclusive<f64> = 0.5..=1.5;
/// Degrees of a radian.
const RADIAN_DEG: f64 = 180.0 / std::f64::consts::PI;

/// A check of the truth, row by row.
#[derive(Debug, Clone)]
pub struct TruthCheck {
    judge: Judge,
    pieces: Pieces,
    tally: Tally,
    faults: Vec<Fault>,
    judged: Vec<LinkedRow>,
}

/// Result of a check of the truth.
#[derive(Debug, Clone)]
pub struct TruthReport {
    /// The findings.
    pub findings: Vec<Finding>,
    /// Lengths that the markers fit over those of the arm; `None` without true headings.
    pub scale: Option<f64>,
    /// Time by which the truth is later than the IMUs, s; `None` where the motion does not determine it.
    pub lag_s: Option<f64>,
    /// Share of the poses that are wrong, repeats of a lower rate aside.
    pub wrong_share: f64,
}

impl TruthCheck {
    /// A check before the first row.
    #[must_use]
    pub fn new(arm: &ArmFile) -> Self {
        Self {
            judge: Judge::new(arm),
            pieces: Pieces::new(arm.segments.len()),
            tally: Tally::new(arm.segments.len()),
            faults: Vec::new(),
            judged: Vec::new(),
        }
    }

    /// Checks the next row, and returns the wrong poses that it has revealed, in this row and earlier ones.
    pub fn update(&mut self, row: &TruthRow) -> &[Fault] {
        self.faults.clear();
        if row.poses.iter().any(Option::is_some) {
            self.tally.add(row);
            self.judge.update(*row, &mut self.faults, &mut self.judged);
            self.take();
        }
        &self.faults
    }

    /// The report, and the wrong poses of the last rows.
    #[must_use]
    pub fn finish(mut self) -> (TruthReport, Vec<Fault>) {
        self.faults.clear();
        self.judge.finish(&mut self.faults, &mut self.judged);
        self.take();
        let Self { pieces, tally, faults, .. } = self;
        let values = pieces.finish();
        let Values { scale, lag_s, .. } = values;
        let mut findings = Vec::new();
        let mut push = |kind, figure| {
            findings.push(Finding { sensor: Source::AllTruth, rows: tally.rows(), kind, figure });
        };
        let unit = scale.and_then(|scale| UNITS.into_iter().find(|unit| is_near(scale, *unit)));
        let is_in_radians = values.turn.is_some_and(|turn| is_near(turn, RADIAN_DEG));
        if let Some(unit) = unit {
            push(Kind::TruthUnit, unit);
        }
        if is_in_radians {
            push(Kind::TruthRadians, values.turn.unwrap_or(RADIAN_DEG));
        }
        let is_turned = |turn: &f64| !is_in_radians && !TURN.contains(turn);
        let axes = values.turn.filter(is_turned);
        if let Some(turn) = axes {
            push(Kind::TruthAxes, turn);
        }
        // Places and headings that do not belong together fit nothing.
        if unit.is_some() || is_in_radians || axes.is_some() {
            return (TruthReport { findings, scale, lag_s, wrong_share: 0.0 }, faults);
        }
        if let Some(scale) = scale.filter(|scale| (scale - 1.0).abs() > LENGTHS) {
            push(Kind::TruthLengths, scale);
        }
        // Repeats are late, the poses between them are not.
        let lag_s = lag_s.filter(|_| !tally.is_staircase());
        if let Some(lag_s) = lag_s.filter(|lag_s| lag_s.abs() > LAG_S) {
            push(Kind::TruthLag, lag_s * 1e3);
        }
        tally.findings(&mut findings);
        (TruthReport { findings, scale, lag_s, wrong_share: tally.wrong_share() }, faults)
    }

    fn take(&mut self) {
        self.judged.drain(..).for_each(|row| self.pieces.add(&row));
        self.faults.iter().for_each(|fault| self.tally.add_fault(fault));
    }
}

fn is_near(found: f64, factor: f64) -> bool {
    (found / factor - 1.0).abs() < TOLERANCE
}
