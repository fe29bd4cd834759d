//! Tuning: Q, R and H of all filters by gradient descent on the RMSE of sessions with truth.
//!
//! 1. Each session runs once through the estimator up to its filters; nothing before them depends on their parameters.
//! 2. Each iteration runs the estimator's own filters over what they measure, in dual numbers, and chains what they say.
//! 3. The last fifth of each session is held back. What gets worse there was tuned to noise, and is not kept.

mod descent;
mod dual;
mod error;
mod errors;
mod filters;
mod objective;
mod parameters;
#[cfg(test)]
mod tests;
mod training;

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, Stopped, TuningKeys};

pub use dual::Dual;
pub use error::TuningError;

use crate::error::Error;
use crate::progress::Progress;
use crate::replay::NamedTable;
use descent::{Iterate, MAX_ITERATIONS, descend};
use errors::Errors;
use objective::{Evaluation, Objective, SessionErrors};
use training::Training;

/// Samples with truth that each part of a session needs.
const LEAST_SAMPLES: u64 = 50;

/// Sessions on which a table can be tuned.
pub struct Tuner<'t> {
    table: &'t NamedTable<'t>,
    objective: Objective,
    before: Evaluation,
}

/// A tuned table.
#[derive(Debug, Clone)]
pub struct Tuning {
    /// The table, with its record of the tuning.
    pub table: ArmFile,
    /// That record.
    pub record: TuningKeys,
}

impl<'t> Tuner<'t> {
    /// Reads the training sessions.
    ///
    /// # Errors
    /// [`Error::Session`] and [`Error::Tuning`] where a session cannot be used, [`Error::Table`] and [`Error::Tuning`] where
    /// the table has no filters.
    pub fn new(sessions: &[PathBuf], table: &'t NamedTable) -> Result<Self, Error> {
        let has_bend_sensors = table.needs()?.bend.iter().any(|sensors| *sensors != Some(0));
        if !has_bend_sensors {
            return Err(Error::Tuning { path: table.path.to_owned(), source: TuningError::NoBendSensors });
        }
        let sessions = sessions.iter().map(|path| Training::read(path, table)).collect::<Result<Vec<_>, _>>()?;
        let objective = Objective::new(sessions, table.bake::<f64>(table.file.rate_hz)?.table().segments);
        let before = objective.of_table(&table.file);
        for (session, errors) in objective.sessions().iter().zip(&before.sessions) {
            errors.check_count().and_then(|()| session.check_truth()).map_err(|source| session.error(source))?;
        }
        Ok(Self { table, objective, before })
    }

    /// The sessions whose last line has no end.
    pub fn cut_sessions(&self) -> impl Iterator<Item = &Path> {
        let cut = self.objective.sessions().iter().filter(|session| !session.ends_with_line);
        cut.map(|session| session.path.as_path())
    }

    /// Descends until the RMSE converges, or until `is_interrupted` after an iteration.
    ///
    /// # Errors
    /// [`Error::Tuning`] where the RMSE is no number, or falls on and on.
    pub fn tune(&self, is_interrupted: impl Fn() -> bool) -> Result<Tuning, Error> {
        let mut progress = Progress::new("tuning".to_owned(), MAX_ITERATIONS);
        let start = self.objective.start(&self.table.file);
        let (mut last, mut best): (Option<Iterate>, Option<Iterate>) = (None, None);
        let stopped = descend(
            |place| self.objective.at(place),
            start,
            |iterate| {
                let rmse = pooled(&iterate.found, |session| &session.training).keys();
                let (tip, heading) = (rmse.tip_rmse_mm, rmse.heading_rmse_deg);
                progress
                    .tell(iterate.number, format!("tuning: RMSE of the tip {tip:.2} mm, of headings {heading:.2} deg"));
                let is_best = |best: &Iterate| iterate.found.held_back_loss < best.found.held_back_loss;
                if best.as_ref().is_none_or(is_best) {
                    best = Some(iterate.clone());
                }
                last = Some(iterate.clone());
                !is_interrupted()
            },
        );
        let stopped = stopped.map_err(|source| Error::Tuning { path: self.table.path.to_owned(), source })?;
        let iterations = last.as_ref().map_or(0, |last| last.number);
        let kept = [last, best].into_iter().flatten().find(|kept| self.is_good(kept));
        Ok(self.tuning(kept, iterations, stopped))
    }

    /// Whether an iterate is worth more than the table as it was.
    fn is_good(&self, iterate: &Iterate) -> bool {
        let Evaluation { loss, held_back_loss, .. } = iterate.found;
        iterate.number > 0 && loss <= self.before.loss && held_back_loss <= self.before.held_back_loss
    }

    fn tuning(&self, kept: Option<Iterate>, iterations: u64, stopped: Stopped) -> Tuning {
        let file = self.table.file.clone();
        let table = kept.as_ref().map_or(file.clone(), |kept| self.objective.table(&kept.place, file));
        let after = self.objective.of_table(&table);
        let record = TuningKeys {
            sessions: self.objective.sessions().iter().map(|session| session.path.display().to_string()).collect(),
            iterations,
            kept: kept.map_or(0, |kept| kept.number),
            stopped,
            before: pooled(&self.before, |session| &session.training).keys(),
            after: pooled(&after, |session| &session.training).keys(),
            held_back_before: pooled(&self.before, |session| &session.held_back).keys(),
            held_back_after: pooled(&after, |session| &session.held_back).keys(),
        };
        Tuning { table: ArmFile { tuning: Some(record.clone()), ..table }, record }
    }
}

impl SessionErrors {
    fn check_count(&self) -> Result<(), TuningError> {
        for (is_held_back, errors) in [(false, &self.training), (true, &self.held_back)] {
            let found = errors.tips.count();
            if found < LEAST_SAMPLES {
                return Err(TuningError::TooFewSamples { is_held_back, found, least: LEAST_SAMPLES });
            }
        }
        Ok(())
    }
}

/// Errors over all sessions.
fn pooled(of: &Evaluation, part: impl Fn(&SessionErrors) -> &Errors) -> Errors {
    let mut all = Errors::default();
    of.sessions.iter().for_each(|session| all.append(part(session)));
    all
}
