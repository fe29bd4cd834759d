//! Errors of one session by the tables of its arm.

use calibration_tables::{ArmFile, FileError};
use estimator_core::{Method, Q};
use host_tests::contact::in_contact;
use host_tests::twin::{TwinSession, replay, replay_smoothed};
use proprio_analysis::Outcome;
use proprio_analysis::metrics::ErrorMetrics;
use proprio_session::Row;
use rig_twin::SEGMENTS;

use crate::arm::Tables;

/// The errors of a session.
pub struct Evaluation {
    pub own: ErrorMetrics,
    pub paper: ErrorMetrics,
    /// Contact by the arm's own table, sample by sample.
    pub contact: Vec<[bool; SEGMENTS]>,
    /// Samples in which the estimator reports a condition.
    pub flagged: usize,
}

/// Figures of a session's tip.
#[derive(Debug, Clone, Copy)]
pub struct Figures {
    /// RMSE of fusion, mm.
    pub fusion_mm: f64,
    /// Share of true tips inside the 95 % ellipse.
    pub inside_percent: f64,
    /// Mean normalised estimation error squared, for each coordinate: 1 is consistent.
    pub nees: f64,
    /// RMSE of the smoothed estimates, mm.
    pub smoothed_mm: f64,
    /// Share of true tips inside the 95 % ellipse of the smoothed estimates.
    pub smoothed_inside_percent: f64,
    /// RMSE of fusion by the paper's method, mm.
    pub paper_mm: f64,
    /// RMSE of the better of bend sensors and raw IMUs, mm.
    pub raw_mm: f64,
    /// Share of samples with a condition.
    pub flagged_percent: f64,
}

impl Evaluation {
    /// Replays rows by both tables.
    pub fn of<R: Iterator<Item = Row>>(tables: &Tables, rate_hz: f64, rows: impl Fn() -> R) -> Result<Self, FileError> {
        let score = || ErrorMetrics::new(tables.own.length_mm());
        let mut evaluation = Self { own: score(), paper: score(), contact: Vec::new(), flagged: 0 };
        replay_smoothed(&tables.own, rate_hz, &rows, |row, outcome| evaluation.add(row, outcome))?;
        replay(&tables.paper, rate_hz, rows(), |row, outcome| evaluation.paper.add(row, outcome))?;
        Ok(evaluation)
    }

    /// Replays a session of the twin.
    pub fn of_twin(tables: &Tables, session: &TwinSession) -> Result<Self, FileError> {
        Self::of(tables, session.rate_hz, || session.rows())
    }

    fn add(&mut self, row: &Row, outcome: &Outcome<Q>) {
        self.own.add(row, outcome);
        self.contact.push(in_contact(outcome));
        self.flagged += usize::from(outcome.conditions.iter().any(|condition| condition.is_degraded()));
    }

    /// The figures.
    pub fn figures(&self) -> Figures {
        let tip_mm = |score: &ErrorMetrics, method: Method| {
            score.metrics()[method as usize].tip_rmse_mm.unwrap_or(f64::INFINITY)
        };
        let consistency = self.own.consistency();
        let smoothed = self.own.smoothed();
        let smoothed_inside = smoothed.and_then(|smoothed| smoothed.uncertainty?.tip_inside_percent);
        let raw = [&self.own, &self.paper].map(|score| tip_mm(score, Method::Bend).min(tip_mm(score, Method::ImuO)));
        Figures {
            fusion_mm: tip_mm(&self.own, Method::Fusion),
            inside_percent: consistency.and_then(|figures| figures.tip_inside_percent).unwrap_or(f64::NAN),
            nees: consistency.and_then(|figures| figures.tip_nees).unwrap_or(f64::NAN),
            smoothed_mm: smoothed.and_then(|smoothed| smoothed.metrics.tip_rmse_mm).unwrap_or(f64::INFINITY),
            smoothed_inside_percent: smoothed_inside.unwrap_or(f64::NAN),
            paper_mm: tip_mm(&self.paper, Method::Fusion),
            raw_mm: raw[0].min(raw[1]),
            flagged_percent: 100.0 * self.flagged as f64 / self.contact.len().max(1) as f64,
        }
    }
}

/// RMSE of fusion by one table, mm.
pub fn fusion_mm(table: &ArmFile, session: &TwinSession) -> Result<f64, FileError> {
    let mut score = ErrorMetrics::new(table.length_mm());
    session.replay(table, |row, outcome| score.add(row, outcome))?;
    Ok(score.metrics()[Method::Fusion as usize].tip_rmse_mm.unwrap_or(f64::INFINITY))
}

/// Mean and largest of figures.
pub fn mean_and_worst(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let (sum, count) = values.clone().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (sum / count, values.fold(f64::NEG_INFINITY, f64::max))
}
