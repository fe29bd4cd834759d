//! A training session: what the camera saw, and what the Kalman filters measure or how far the fused shape is off.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::{Estimator, Sample};
use proprio_analysis::HostEstimator;
use proprio_session::{NamedTable, Needs, Progress, SessionReader, Truth};

use super::error::TuningError;
use super::errors::{Errors, ends};
use super::objective::SessionErrors;
use crate::calibrate::{MISFIT_PERCENT, constant_curvature_error};
use crate::error::Error;

/// Of a session of which a part is held back, one in so many samples, those at the end.
const HELD_BACK: usize = 5;
/// One in so many sessions is held back as a whole, where there are as many.
const HELD_BACK_SESSIONS: usize = 3;
/// Samples with truth that each part of a session needs.
const LEAST_SAMPLES: u64 = 50;
/// An arm of which no true heading changes by more than this does not move, degrees.
const STILL_DEG: f64 = 10.0;

/// One segment in one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    /// θ_c as the filters take it, rad.
    pub imu_c: Option<f64>,
    /// θ_bend, rad.
    pub bend: Option<f64>,
    pub truth: Option<Truth>,
}

impl Measured {
    const fn unknown(truth: Option<Truth>) -> Self {
        Self { imu_c: None, bend: None, truth }
    }
}

/// What a session is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// To train on.
    Seen,
    /// To judge by.
    HeldBack,
    /// The last fifth to judge by, the rest to train on.
    Both,
}

impl Part {
    /// Of session `k` of `count`.
    pub fn of_session(k: usize, count: usize) -> Self {
        match k % HELD_BACK_SESSIONS {
            _ if count < HELD_BACK_SESSIONS => Self::Both,
            2 => Self::HeldBack,
            _ => Self::Seen,
        }
    }
}

/// One session.
#[derive(Debug)]
pub(super) struct Training {
    pub path: PathBuf,
    part: Part,
    pub rate_hz: f64,
    pub ends_with_line: bool,
    /// Root mean square distance of the true tip from the chain of the true bend angles, % of the arm's length.
    misfit_percent: f64,
    segments: usize,
    samples: Vec<Sample<MAX_SEGMENTS>>,
    measured: Vec<Measured>,
    /// Errors of the fused shape; `None` with the anchor, where they depend on the Kalman filters.
    fused: Option<SessionErrors>,
    /// Rows before which the estimator starts anew.
    starts: Vec<bool>,
}

/// One sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment<'t> {
    pub is_held_back: bool,
    /// Whether the filters start anew before it.
    pub starts: bool,
    /// Its segments.
    pub measured: &'t [Measured],
}

impl Training {
    /// Reads a session and [measures](Self::measure) it.
    pub fn read(session: &Path, part: Part, table: &NamedTable, progress: &mut dyn Progress) -> Result<Self, Error> {
        let mut reader = SessionReader::open(session, &Needs { truth: true, ..table.needs()? })?;
        let rate_hz = reader.rate_hz(table.file.rate_hz);
        let compiled = table.compile::<f64>(rate_hz)?;
        let segments = compiled.config().segments;

        let work = format!("reading {}", session.display());
        let (mut samples, mut measured, mut starts) = (Vec::new(), Vec::new(), Vec::new());
        let (mut misfit, mut tips) = (0.0, 0.0);
        while let Some(row) = reader.next_row()? {
            if let Some(distance) = constant_curvature_error(&row, segments) {
                (misfit, tips) = (misfit + distance * distance, tips + 1.0);
            }
            samples.push(row.sample);
            measured.extend(row.truth.iter().take(segments.len()).map(|truth| Measured::unknown(*truth)));
            starts.push(row.starts);
            progress.advance(&work, reader.progress());
        }
        let mut training = Self {
            path: session.to_owned(),
            part,
            rate_hz,
            ends_with_line: reader.ends_with_line(),
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
        let seen = self.seen();
        self.fused = table.bias_filter().map(|_| SessionErrors::default());
        let rows = self.measured.chunks_exact_mut(self.segments).zip(&self.samples).zip(&self.starts);
        for (row, ((measured, sample), starts)) in rows.enumerate() {
            if *starts {
                estimator.start().expect("the file was checked");
            }
            if let Some(errors) = &mut self.fused {
                let ends = ends(estimator.update(sample).iter().copied(), measured);
                let part = if row < seen { &mut errors.training } else { &mut errors.held_back };
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

    /// How many samples are not held back.
    pub fn seen(&self) -> usize {
        match self.part {
            Part::Seen => self.samples.len(),
            Part::HeldBack => 0,
            Part::Both => self.samples.len() - self.samples.len() / HELD_BACK,
        }
    }

    /// All samples.
    pub fn rows(&self) -> impl Iterator<Item = Moment<'_>> {
        let seen = self.seen();
        let rows = self.measured.chunks_exact(self.segments).zip(&self.starts).enumerate();
        rows.map(move |(row, (measured, starts))| Moment { is_held_back: row >= seen, starts: *starts, measured })
    }

    /// An error of this session.
    pub fn error(&self, source: TuningError) -> Error {
        Error::Tuning { path: self.path.clone(), source }
    }

    /// Whether the truth hangs together, and moves.
    pub fn check_truth(&self) -> Result<(), TuningError> {
        if self.misfit_percent > MISFIT_PERCENT {
            return Err(TuningError::TruthMisfit { percent: self.misfit_percent });
        }
        let range_deg = (0..self.segments).map(|i| self.heading_range_deg(i)).fold(0.0, f64::max);
        if range_deg < STILL_DEG { Err(TuningError::Still { range_deg, least_deg: STILL_DEG }) } else { Ok(()) }
    }

    /// Whether there is enough truth in each part of it.
    pub fn check_count(&self, errors: &SessionErrors) -> Result<(), TuningError> {
        let parts: &[(&'static str, &Errors)] = match self.part {
            Part::Seen => &[("it", &errors.training)],
            Part::HeldBack => &[("it", &errors.held_back)],
            Part::Both => &[
                ("the part before the last fifth", &errors.training),
                ("the last fifth, which is held back,", &errors.held_back),
            ],
        };
        let found = parts.iter().map(|(part, errors)| (*part, errors.tips.count()));
        match found.into_iter().find(|(_, found)| *found < LEAST_SAMPLES) {
            Some((part, found)) => Err(TuningError::TooFewSamples { part, found, least: LEAST_SAMPLES }),
            None => Ok(()),
        }
    }

    /// From the smallest to the largest true heading of one segment's end.
    fn heading_range_deg(&self, segment: usize) -> f64 {
        let headings = self.rows().filter_map(|moment| moment.measured[segment].truth?.heading_rad);
        let [lo, hi] = headings.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], h| [lo.min(h), hi.max(h)]);
        (hi - lo).to_degrees()
    }
}
