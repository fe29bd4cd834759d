//! Tuning on sessions with truth: of the filters by the RMSE of the fused shape, of the variances by its errors.
//!
//! 1. A table with the bias filter: its Kalman filters are bypassed, so a search tries other parameters of the bias filter.
//!    Each try is a run of the estimator, evaluated by the errors of the fused shape.
//! 2. A table with the anchor: Q, R and H of all Kalman filters. Nothing before the filters depends on their parameters, so
//!    gradient descent runs the estimator's own filters over their inputs, in dual numbers, and chains the derivatives.
//! 3. Every third session is for validation, or the last fifth of each where there are fewer than three. Parameters that are
//!    worse there are fitted to noise or to one motion, and are not kept.
//! 4. Where the table has error sources, all variances grow by one factor if they are too small (covariance inflation).

mod descent;
mod dual;
mod error;
mod errors;
mod filters;
mod objective;
mod parameters;
mod sample;
mod search;
#[cfg(test)]
mod tests;
mod training;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use calibration_tables::{ArmFile, DriftToml, DriftTuningToml, StopReason, TuningToml};
use proprio_analysis::consistency::FilterConsistency;
use proprio_analysis::replay::replay;
use proprio_session::{FileDefects, LoadedTable, Progress};

pub use dual::Dual;
pub use error::TuningError;

use crate::error::Error;
use crate::truth::JudgedTruth;
use descent::{Iterate, MAX_ITERATIONS, descend};
use errors::{Errors, SessionErrors};
use objective::{Evaluation, Objective};
use search::{MAX_RUNS, filter_at, search};
use training::{Part, Training};

/// Sessions on which a table can be tuned.
pub struct Tuner<'t> {
    table: &'t LoadedTable<'t>,
    objective: Objective,
    before: Evaluation,
}

/// A tuned table.
#[derive(Debug, Clone)]
pub struct Tuning {
    /// The table, with its record of the tuning.
    pub table: ArmFile,
    /// The record of the tuning.
    pub record: TuningToml,
    /// Time of an iteration of the descent; zero with the bias filter, which has no descent.
    pub iteration_time: Duration,
}

impl<'t> Tuner<'t> {
    /// Reads the training sessions.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::Tuning`] where a session cannot be used or the table has no filters.
    pub fn new(sessions: &[PathBuf], table: &'t LoadedTable, progress: &mut dyn Progress) -> Result<Self, Error> {
        let has_bend_sensors = table.required_columns()?.bend.iter().any(|sensors| *sensors != Some(0));
        if !has_bend_sensors {
            return Err(Error::Tuning { path: table.path.to_owned(), source: TuningError::NoBendSensors });
        }
        let count = sessions.len();
        let part = |k| Part::of_session(k, count);
        let mut read = |(k, path): (usize, &PathBuf)| Training::read(path, part(k), table, progress);
        let sessions = sessions.iter().enumerate().map(&mut read).collect::<Result<Vec<_>, _>>()?;
        let objective = Objective::new(sessions, table.compile::<f64>(table.file.rate_hz)?.config().segments);
        let before = objective.of_table(&table.file);
        for (session, errors) in objective.sessions().iter().zip(&before.sessions) {
            session.check_count(errors).and_then(|()| session.check_truth()).map_err(|source| session.error(source))?;
        }
        Ok(Self { table, objective, before })
    }

    /// Each session with the defects of its file.
    pub fn defects(&self) -> impl Iterator<Item = (&Path, &FileDefects)> {
        self.objective.sessions().iter().map(|session| (session.path.as_path(), &session.defects))
    }

    /// The truth of each session.
    pub fn truth(&self) -> impl Iterator<Item = &JudgedTruth> {
        self.objective.sessions().iter().map(|session| &session.truth)
    }

    /// Searches or descends until the RMSE converges, or until `is_interrupted` after a run or an iteration.
    ///
    /// # Errors
    /// [`Error::Tuning`] where the RMSE of descent is not finite or does not converge; [`Error::File`] where a session has
    /// changed.
    pub fn tune(mut self, progress: &mut dyn Progress, is_interrupted: impl Fn() -> bool) -> Result<Tuning, Error> {
        let start = Instant::now();
        let Tuned { mut table, drift, iterations, kept, stopped } = match self.table.file.bias_filter() {
            Some(start) => self.tune_bias_filter(start, progress, &is_interrupted),
            None => self.tune_filters(progress, &is_interrupted)?,
        };
        let descended = if drift.is_none() { start.elapsed() } else { Duration::ZERO };
        let iteration_time = descended.div_f64(iterations.max(1) as f64);
        let variances = self.inflate_covariance(&mut table, progress)?;
        let after = self.objective.of_table(&table);
        let record = TuningToml {
            sessions: self.objective.sessions().iter().map(|session| session.path.display().to_string()).collect(),
            date: None,
            iterations,
            best_iteration: kept,
            stop_reason: stopped,
            covariance_inflation: variances,
            drift,
            observer: serde::de::IgnoredAny,
            before: pooled(&self.before, |session| &session.training).keys(),
            after: pooled(&after, |session| &session.training).keys(),
            validation_before: pooled(&self.before, |session| &session.validation).keys(),
            validation_after: pooled(&after, |session| &session.validation).keys(),
        };
        Ok(Tuning { table: ArmFile { tuning: Some(record.clone()), ..table }, record, iteration_time })
    }

    /// The table with the best bias filter whose validation error is no worse, and measures the sessions with it.
    fn tune_bias_filter(
        &mut self,
        start: &DriftToml,
        progress: &mut dyn Progress,
        is_interrupted: impl Fn() -> bool,
    ) -> Tuned {
        let mut table = self.table.file.clone();
        let (mut runs, mut stopped) = (0, StopReason::Converged);
        let candidates = search(self.before.clone(), |place| {
            table.drift = Some(filter_at(start, place));
            self.objective.measure(&table);
            let found = self.objective.of_table(&table);
            runs += 1;
            progress.complete(&format!("tuning the bias filter: {}", progress_text(&found)), (runs, MAX_RUNS as u64));
            if is_interrupted() {
                stopped = StopReason::Interrupted;
                return None;
            }
            Some(found)
        });
        let kept =
            candidates.iter().rev().find(|candidate| candidate.found.validation_loss <= self.before.validation_loss);
        let tuned = kept.map_or_else(|| start.clone(), |kept| filter_at(start, &kept.place));
        let record = DriftTuningToml {
            runs,
            rate_deg_per_s: [start.rate_deg_per_s, tuned.rate_deg_per_s],
            rate_random_walk_deg_per_s_sqrt_s: [
                start.rate_random_walk_deg_per_s_sqrt_s,
                tuned.rate_random_walk_deg_per_s_sqrt_s,
            ],
            angle_random_walk_deg_per_sqrt_s: [
                start.angle_random_walk_deg_per_sqrt_s,
                tuned.angle_random_walk_deg_per_sqrt_s,
            ],
            offset_deg: [start.offset_deg, tuned.offset_deg],
            offset_s: [start.offset_s, tuned.offset_s],
        };
        table.drift = Some(tuned);
        self.objective.measure(&table);
        Tuned { table, drift: Some(record), iterations: 0, kept: 0, stopped }
    }

    /// The table with better Kalman filters.
    fn tune_filters(&self, progress: &mut dyn Progress, is_interrupted: impl Fn() -> bool) -> Result<Tuned, Error> {
        let table = &self.table.file;
        let before = &self.before;
        let (mut last, mut best): (Option<Iterate>, Option<Iterate>) = (None, None);
        let stopped = descend(
            |place| self.objective.at(place),
            self.objective.start(table),
            |iterate| {
                progress
                    .complete(&format!("tuning: {}", progress_text(&iterate.found)), (iterate.number, MAX_ITERATIONS));
                let is_best = |best: &Iterate| iterate.found.validation_loss < best.found.validation_loss;
                if best.as_ref().is_none_or(is_best) {
                    best = Some(iterate.clone());
                }
                last = Some(iterate.clone());
                !is_interrupted()
            },
        );
        let stopped = stopped.map_err(|source| Error::Tuning { path: self.table.path.to_owned(), source })?;
        let iterations = last.as_ref().map_or(0, |last| last.number);
        let is_good = |iterate: &Iterate| {
            let Evaluation { loss, validation_loss, .. } = iterate.found;
            iterate.number > 0 && loss <= before.loss && validation_loss <= before.validation_loss
        };
        let kept = [last, best].into_iter().flatten().find(is_good);
        let number = kept.as_ref().map_or(0, |kept| kept.number);
        let table = kept.map_or(table.clone(), |kept| self.objective.table(&kept.place, table.clone()));
        Ok(Tuned { table, drift: None, iterations, kept: number, stopped })
    }

    /// Covariance inflation: multiplies all variances by the NEES of the ends on the training part, where it is above 1, and
    /// returns the factor. Variances that are too large stay, as later motion may be less gentle.
    fn inflate_covariance(&self, table: &mut ArmFile, progress: &mut dyn Progress) -> Result<Option<f64>, Error> {
        let Some(keys) = table.uncertainty.clone() else { return Ok(None) };
        let mut consistency = FilterConsistency::default();
        let named = LoadedTable { file: table.clone(), path: self.table.path };
        for session in self.objective.sessions() {
            let mut number = 0;
            replay::<f64>(&session.path, &named, progress, |row, outcome| {
                if number < session.training_count() {
                    consistency.add(&session.left_out.without(row, number), outcome);
                }
                number += 1;
                Ok(())
            })?;
        }
        let factor = consistency.metrics().end_nees.filter(|nees| nees.is_finite()).map_or(1.0, |nees| nees.max(1.0));
        table.uncertainty = Some(keys.scaled(factor));
        Ok(Some(factor))
    }
}

/// Result of the search or of the descent.
struct Tuned {
    table: ArmFile,
    /// Record of the search.
    drift: Option<DriftTuningToml>,
    /// Iterations of the descent.
    iterations: u64,
    /// Iteration of the table's filters.
    kept: u64,
    stopped: StopReason,
}

/// The errors on the training part, for people.
fn progress_text(of: &Evaluation) -> String {
    let rmse = pooled(of, |session| &session.training).keys();
    format!("RMSE of the tip {:.2} mm, of headings {:.2} deg", rmse.tip_rmse_mm, rmse.heading_rmse_deg)
}

/// Errors over all sessions.
fn pooled(of: &Evaluation, part: impl Fn(&SessionErrors) -> &Errors) -> Errors {
    let mut all = Errors::default();
    of.sessions.iter().for_each(|session| all.append(part(session)));
    all
}
