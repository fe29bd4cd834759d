//! A training session: its truth, and the inputs of the Kalman filters or the errors of the fused shape.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::{Estimator, Sample};
use proprio_analysis::HostEstimator;
use proprio_analysis::check::truth::{LeftOut, TruthRow};
use proprio_session::{FileDefects, LoadedTable, Progress, RequiredColumns, SessionReader};

use super::error::TuningError;
use super::errors::{Errors, SessionErrors, ends};
use super::sample::{Measured, TrainingSample};
use crate::calibrate::{MISFIT_PERCENT, constant_curvature_error};
use crate::error::Error;
use crate::truth::{JudgedTruth, TruthJudge};

/// One in this number of samples, at the end of a session, is for validation where no whole session is.
const VALIDATION_SAMPLES: usize = 5;
/// One in this number of sessions is for validation as a whole, where there are as many.
const VALIDATION_SESSIONS: usize = 3;
/// Fewest samples with truth of each part of a session.
const LEAST_SAMPLES: u64 = 50;
/// Largest range of the true headings of an arm that does not move, degrees.
const STILL_DEG: f64 = 10.0;

/// Use of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Training.
    Training,
    /// Validation.
    Validation,
    /// The last fifth for validation, the rest for training.
    Both,
}

impl Part {
    /// Use of session `k` of `count`.
    pub fn of_session(k: usize, count: usize) -> Self {
        match k % VALIDATION_SESSIONS {
            _ if count < VALIDATION_SESSIONS => Self::Both,
            2 => Self::Validation,
            _ => Self::Training,
        }
    }
}

/// One session.
#[derive(Debug)]
pub(super) struct Training {
    pub path: PathBuf,
    part: Part,
    pub rate_hz: f64,
    pub defects: FileDefects,
    pub truth: JudgedTruth,
    /// The wrong poses, which are not in the samples.
    pub left_out: LeftOut,
    /// Root mean square distance of the true tip from the chain of the true bend angles, % of the arm's length.
    misfit_percent: f64,
    segments: usize,
    samples: Vec<Sample<MAX_SEGMENTS>>,
    measured: Vec<Measured>,
    /// Errors of the fused shape; `None` with the anchor, where they depend on the Kalman filters.
    fused: Option<SessionErrors>,
    /// Rows before which the estimator is started (again).
    starts: Vec<bool>,
}

impl Training {
    /// Reads a session and [measures](Self::measure) it.
    pub fn read(session: &Path, part: Part, table: &LoadedTable, progress: &mut dyn Progress) -> Result<Self, Error> {
        let mut reader = SessionReader::open(session, &RequiredColumns { truth: true, ..table.required_columns()? })?;
        let rate_hz = reader.rate_hz(table.file.rate_hz)?;
        let compiled = table.compile::<f64>(rate_hz)?;
        let segments = compiled.config().segments;

        let work = format!("reading {}", session.display());
        let (mut samples, mut measured, mut starts) = (Vec::new(), Vec::new(), Vec::new());
        let mut distances = Vec::new();
        let mut judge = TruthJudge::new(session, &table.file);
        while let Some(row) = reader.next_row()? {
            judge.update(&TruthRow::of(&row, samples.len() as u64 + 1));
            distances.push(constant_curvature_error(&row, segments));
            samples.push(row.sample);
            measured.extend(row.truth.iter().take(segments.len()).map(|truth| Measured::unknown(*truth)));
            starts.push(row.starts);
            progress.advance(&work, reader.progress());
        }
        let (truth, left_out) = judge.finish()?;
        truth.check_lengths()?;
        for (place, measured) in measured.iter_mut().enumerate() {
            let (row, i) = (place / segments.len(), place % segments.len());
            measured.truth = measured.truth.filter(|_| !left_out.contains(row, i));
        }
        let is_whole = |row: usize| (0..segments.len()).all(|i| !left_out.contains(row, i));
        let (mut misfit, mut tips) = (0.0, 0.0);
        for (_, distance) in distances.iter().enumerate().filter(|(row, _)| is_whole(*row)) {
            let Some(distance) = distance else { continue };
            (misfit, tips) = (misfit + distance * distance, tips + 1.0);
        }
        let mut training = Self {
            path: session.to_owned(),
            part,
            rate_hz,
            defects: reader.defects(),
            truth,
            left_out,
            misfit_percent: (misfit / f64::max(tips, 1.0)).sqrt() * 1e5 / table.file.length_mm(),
            segments: segments.len(),
            samples,
            measured,
            fused: None,
            starts,
        };
        training.measure(&table.file);
        Ok(training)
    }

    /// Runs the estimator on all samples. With the bias filter, which bypasses the Kalman filters, it computes the errors of
    /// the fused shape; with the anchor, the inputs of the Kalman filters, which do not depend on their parameters.
    pub fn measure(&mut self, table: &ArmFile) {
        let compiled = table.compile::<f64>(self.rate_hz).expect("it is a table");
        let compiled = compiled.config();
        let mut estimator: Box<HostEstimator<f64>> = Box::new(Estimator::new(&compiled).expect("the file was checked"));
        let training = self.training_count();
        self.fused = table.bias_filter().map(|_| SessionErrors::default());
        let rows = self.measured.chunks_exact_mut(self.segments).zip(&self.samples).zip(&self.starts);
        for (row, ((measured, sample), starts)) in rows.enumerate() {
            if *starts {
                estimator.start().expect("the file was checked");
            }
            if let Some(errors) = &mut self.fused {
                let ends = ends(estimator.update(sample).iter().copied(), measured);
                let part = if row < training { &mut errors.training } else { &mut errors.validation };
                part.add(&ends, self.segments);
                continue;
            }
            let estimate = estimator.update_full(sample);
            for (measured, segment) in measured.iter_mut().zip(&estimate.segments) {
                // Without whole turns, as the filters take them.
                let thetas = [segment.imu_c, segment.bend].map(|link| link.map(|link| link.theta.remainder));
                [measured.imu_c, measured.bend] = thetas;
            }
        }
    }

    /// Errors of the fused shape with the table that it was measured with; `None` with the anchor.
    pub fn fused(&self) -> Option<SessionErrors> {
        self.fused
    }

    /// Number of samples for training.
    pub fn training_count(&self) -> usize {
        match self.part {
            Part::Training => self.samples.len(),
            Part::Validation => 0,
            Part::Both => self.samples.len() - self.samples.len() / VALIDATION_SAMPLES,
        }
    }

    /// All samples.
    pub fn rows(&self) -> impl Iterator<Item = TrainingSample<'_>> {
        let training = self.training_count();
        let rows = self.measured.chunks_exact(self.segments).zip(&self.starts).enumerate();
        rows.map(move |(row, (measured, starts))| TrainingSample {
            is_validation: row >= training,
            starts: *starts,
            measured,
        })
    }

    /// An error of this session.
    pub fn error(&self, source: TuningError) -> Error {
        Error::Tuning { path: self.path.clone(), source }
    }

    /// Checks that the truth is consistent and moves.
    pub fn check_truth(&self) -> Result<(), TuningError> {
        if self.misfit_percent > MISFIT_PERCENT {
            return Err(TuningError::TruthMisfit { percent: self.misfit_percent });
        }
        let range_deg = (0..self.segments).map(|i| self.heading_range_deg(i)).fold(0.0, f64::max);
        if range_deg < STILL_DEG { Err(TuningError::Still { range_deg, least_deg: STILL_DEG }) } else { Ok(()) }
    }

    /// Checks that there is enough truth in each part of it.
    pub fn check_count(&self, errors: &SessionErrors) -> Result<(), TuningError> {
        let parts: &[(&'static str, &Errors)] = match self.part {
            Part::Training => &[("it", &errors.training)],
            Part::Validation => &[("it", &errors.validation)],
            Part::Both => &[
                ("the part before the last fifth", &errors.training),
                ("the last fifth, which is for validation,", &errors.validation),
            ],
        };
        let found = parts.iter().map(|(part, errors)| (*part, errors.tips.count()));
        match found.into_iter().find(|(_, found)| *found < LEAST_SAMPLES) {
            Some((part, found)) => Err(TuningError::TooFewSamples { part, found, least: LEAST_SAMPLES }),
            None => Ok(()),
        }
    }

    /// Range of the true heading of one segment's end, degrees.
    fn heading_range_deg(&self, segment: usize) -> f64 {
        let headings = self.rows().filter_map(|moment| moment.measured[segment].truth?.heading_rad);
        let [lo, hi] = headings.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], h| [lo.min(h), hi.max(h)]);
        (hi - lo).to_degrees()
    }
}
