//! The filters' default parameters, from the errors of bend sensors and IMUs on the calibration session.
//!
//! R_bend is the mean square of each segment's error by its bend sensors. R_imu is R_bend times a ratio of two mean squares,
//! for which the IMUs' error is the one with an anchor by perfect bend sensors. The anchor adds the slow part of the bend
//! sensors' error to it; this part is in both measurements, no filter can remove it, and it must not count against one of them.
//!
//! For KF_coord these are the errors of a segment's end in its own frame. For KF_orient they are those of the headings
//! that the bend angles add up to, the same for the whole arm: along the chain the errors of bend sensors grow, where
//! those of IMUs do not, as each heading is measured separately.

use std::path::PathBuf;

use calibration_tables::{MAX_WINDOW, NoiseToml};
use estimator_core::{
    AnchorConfig, Angle, ArmConfig, Decimated, Decimator, MovingAverageAnchor, Pcc, SegmentConfig, SegmentEstimate,
    Turns,
};
use nalgebra::Vector2;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, Progress, Row};

use super::sweep::Sweep;
use crate::error::Error;

/// Bounds of R_imu : R_bend for KF_orient and for KF_coord: the session is only a sample, and slower than what follows.
const ORIENT_RATIO: [f64; 2] = [0.01, 1.0];
const COORD_RATIO: [f64; 2] = [0.1, 1.0];

/// Mean squares of errors.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    imu: f64,
    bend: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, imu_square: f64, bend_square: f64, coordinates: f64) {
        self.imu += imu_square;
        self.bend += bend_square;
        self.count += coordinates;
    }

    fn ratio(&self, [lo, hi]: [f64; 2]) -> f64 {
        (self.imu / self.bend).clamp(lo, hi)
    }

    /// Parameters with these errors' R_bend; `None` where the two measurements never coincided.
    fn noise(&self, ratio: f64) -> Option<NoiseToml> {
        let r_bend = self.bend / self.count;
        (r_bend > 0.0).then(|| NoiseToml::from_variances(ratio * r_bend, r_bend))
    }
}

/// Accumulated errors of one segment in a replay.
struct ResidualAccumulator<'t> {
    segment: &'t SegmentConfig<f64>,
    /// Anchor to the truth, in place of perfect bend sensors.
    anchor: MovingAverageAnchor<{ MAX_WINDOW as usize }>,
    orient: Errors,
    coord: Errors,
}

/// Accumulated errors of the arm.
struct Residuals<'t> {
    accumulators: Vec<ResidualAccumulator<'t>>,
    headings: Errors,
    decimator: Decimator,
    anchor: AnchorConfig,
}

/// Sets `orient` and `coord` of every segment that has bend sensors, from the rows of the sessions that are in the sweep.
pub(super) fn set_filters(
    sessions: &[PathBuf],
    sweep: &Sweep,
    table: &mut LoadedTable,
    progress: &mut dyn Progress,
) -> Result<(), Error> {
    let compiled = table.compile::<f64>(sweep.rate_hz)?;
    let compiled = compiled.config();
    let mut residuals = Residuals::new(&compiled);
    for (number, session) in sessions.iter().enumerate() {
        let rows = sweep.sessions.iter().filter(|of| **of == number).count();
        let left_out = &sweep.left_out[number];
        let mut row_number = 0;
        residuals.start();
        replay::<f64>(session, table, progress, |row, outcome| {
            if row_number < rows {
                residuals.add_row(&left_out.without(row, row_number), &outcome.estimate.segments);
                row_number += 1;
            }
            Ok(())
        })?;
    }
    let Residuals { accumulators, headings, .. } = residuals;
    for (segment, accumulator) in table.file.segments.iter_mut().zip(&accumulators) {
        segment.orient = accumulator.orient.noise(headings.ratio(ORIENT_RATIO));
        segment.coord = accumulator.coord.noise(accumulator.coord.ratio(COORD_RATIO));
    }
    Ok(())
}

impl<'t> Residuals<'t> {
    fn new(config: &ArmConfig<'t, f64>) -> Self {
        let accumulator = |segment| ResidualAccumulator {
            segment,
            anchor: MovingAverageAnchor::new(),
            orient: Errors::default(),
            coord: Errors::default(),
        };
        Self {
            accumulators: config.segments.iter().map(accumulator).collect(),
            headings: Errors::default(),
            decimator: Decimator::new(),
            anchor: config.anchor,
        }
    }

    /// Resets the anchors at a start of the estimator.
    fn start(&mut self) {
        self.decimator = Decimator::new();
        for accumulator in &mut self.accumulators {
            accumulator.anchor = MovingAverageAnchor::new();
        }
    }

    fn add_row(&mut self, row: &Row, estimates: &[SegmentEstimate<f64>]) {
        if row.starts {
            self.start();
        }
        let slot = self.decimator.advance(&self.anchor);
        let mut sums = Some([0.0, 0.0]);
        for (i, (accumulator, estimate)) in self.accumulators.iter_mut().zip(estimates).enumerate() {
            let errors = accumulator.add_row(row.true_theta(i), estimate, slot);
            sums = sums.zip(errors).map(|(sums, errors)| [sums[0] + errors[0], sums[1] + errors[1]]);
            if let Some([imu, bend]) = sums {
                self.headings.add(imu * imu, bend * bend, 1.0);
            }
        }
    }
}

impl ResidualAccumulator<'_> {
    /// Adds one row; returns the errors of θ by the IMUs and by the bend sensors, rad, where both are known.
    fn add_row(&mut self, truth: Option<f64>, estimate: &SegmentEstimate<f64>, slot: Decimated) -> Option<[f64; 2]> {
        let imu = estimate.imu_o.map(Angle::rad);
        self.anchor.push(slot, imu.zip(truth).map(|(imu, truth)| Turns::from_rad(imu - truth)));
        let (truth, imu, bend) = (truth?, imu? - self.anchor.offset()?.rad(), estimate.bend?);

        let errors = [imu - truth, bend.theta.rad() - truth];
        self.orient.add(errors[0].powi(2), errors[1].powi(2), 1.0);
        let end = |theta: f64| Pcc::new(self.segment).link(Angle::from(theta)).end;
        let square = |point: Vector2<f64>| (point - end(truth)).norm_squared();
        self.coord.add(square(end(imu)), square(bend.end), 2.0);
        Some(errors)
    }
}
