//! A training session as descent needs it: what the filters measure, and what the camera saw.

use std::path::{Path, PathBuf};

use estimator_core::Estimator;

use super::error::TuningError;
use crate::calibrate::{MISFIT_PERCENT, truth_misfit};
use crate::error::Error;
use crate::progress::Progress;
use crate::replay::{HostEstimator, NamedTable};
use crate::session::{Needs, SessionReader, Truth};

/// One in so many samples is held back, those at the end.
const HELD_BACK: usize = 5;
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

/// One session.
#[derive(Debug)]
pub(super) struct Training {
    pub path: PathBuf,
    pub rate_hz: f64,
    pub ends_with_line: bool,
    /// Root mean square distance of the true tip from the chain of the true bend angles, % of the arm's length.
    misfit_percent: f64,
    segments: usize,
    measured: Vec<Measured>,
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
    /// Runs a session through that part of the estimator on which no filter's parameters act.
    pub fn read(session: &Path, table: &NamedTable) -> Result<Self, Error> {
        let mut reader = SessionReader::open(session, &Needs { truth: true, ..table.needs()? })?;
        let rate_hz = reader.rate_hz(table.file.rate_hz);
        let baked = table.bake::<f64>(rate_hz)?;
        let baked = baked.table();
        let mut estimator: Box<HostEstimator<f64>> = Box::new(Estimator::new(&baked).expect("the file was checked"));

        let mut progress = Progress::new(format!("reading {}", session.display()), reader.progress().1);
        let (mut measured, mut starts, mut misfit, mut tips) = (Vec::new(), Vec::new(), 0.0, 0.0);
        while let Some(row) = reader.next_row()? {
            if let Some(distance) = truth_misfit(&row, baked.segments) {
                (misfit, tips) = (misfit + distance * distance, tips + 1.0);
            }
            if row.starts {
                estimator.start().expect("the file was checked");
            }
            starts.push(row.starts);
            let estimate = estimator.step(&row.sample);
            measured.extend(estimate.segments.iter().zip(row.truth).map(|(segment, truth)| {
                // Without whole turns, as the filters take them.
                let [imu_c, bend] = [segment.imu_c, segment.bend].map(|link| link.map(|link| link.theta.rest));
                Measured { imu_c, bend, truth }
            }));
            progress.set(reader.progress().0);
        }
        Ok(Self {
            path: session.to_owned(),
            rate_hz,
            ends_with_line: reader.ends_with_line(),
            misfit_percent: (misfit / f64::max(tips, 1.0)).sqrt() * 1e5 / table.file.length_mm(),
            segments: baked.segments.len(),
            measured,
            starts,
        })
    }

    /// All samples.
    pub fn rows(&self) -> impl Iterator<Item = Moment<'_>> {
        let rows = self.measured.chunks_exact(self.segments);
        let seen = rows.len() - rows.len() / HELD_BACK;
        let rows = rows.zip(&self.starts).enumerate();
        rows.map(move |(row, (measured, starts))| Moment { is_held_back: row >= seen, starts: *starts, measured })
    }

    /// An error of this session.
    pub fn error(&self, source: TuningError) -> Error {
        Error::Tuning { path: self.path.clone(), source }
    }

    /// Whether the truth hangs together, and moves while descent looks at it.
    pub fn check_truth(&self) -> Result<(), TuningError> {
        if self.misfit_percent > MISFIT_PERCENT {
            return Err(TuningError::TruthMisfit { percent: self.misfit_percent });
        }
        let range_deg = (0..self.segments).map(|i| self.heading_range_deg(i)).fold(0.0, f64::max);
        if range_deg < STILL_DEG { Err(TuningError::Still { range_deg, least_deg: STILL_DEG }) } else { Ok(()) }
    }

    /// From the smallest to the largest true heading of one segment's end.
    fn heading_range_deg(&self, segment: usize) -> f64 {
        let rows = self.rows().filter(|moment| !moment.is_held_back);
        let headings = rows.filter_map(|moment| moment.measured[segment].truth?.heading_rad);
        let [lo, hi] = headings.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], h| [lo.min(h), hi.max(h)]);
        (hi - lo).to_degrees()
    }
}
