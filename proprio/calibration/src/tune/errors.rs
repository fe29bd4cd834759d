//! Errors of the fused shape against the truth.

use std::f64::consts::TAU;

use calibration_tables::RmseToml;
use estimator_core::SegmentShape;
use nalgebra::Vector2;

use super::sample::Measured;

/// The fused end of one segment in {W}.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    /// m.
    pub point: Vector2<f64>,
    /// rad.
    pub heading: f64,
    /// Error against the true end; `None` where the camera did not see it.
    pub error: Option<EndError>,
}

/// Error of an end.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndError {
    /// m.
    pub point: Vector2<f64>,
    /// rad.
    pub heading: f64,
}

/// The ends of a shape up to the first unknown one.
pub(super) fn ends(shape: impl Iterator<Item = SegmentShape<f64>>, measured: &[Measured]) -> Vec<End> {
    let mut heading = 0.0;
    let end = |(segment, measured): (SegmentShape<f64>, &Measured)| {
        let (theta, point) = segment.theta.zip(segment.end)?;
        heading += theta.rad();
        let error = measured.truth.and_then(|truth| {
            let turn = heading - truth.heading_rad?;
            let heading = turn - TAU * (turn / TAU).round();
            Some(EndError { point: point - Vector2::new(truth.x_m, truth.y_m), heading })
        });
        Some(End { point, heading, error })
    };
    shape.zip(measured).map_while(end).collect()
}

/// Squares of errors.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Squares {
    sum: f64,
    count: u64,
}

impl Squares {
    fn add(&mut self, square: f64) {
        self.sum += square;
        self.count += 1;
    }

    fn append(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }

    pub fn count(self) -> u64 {
        self.count
    }

    pub fn rms(self) -> f64 {
        (self.sum / self.count as f64).sqrt()
    }

    /// Derivative of the root mean square by half the sum of squares.
    pub fn slope(self) -> f64 {
        1.0 / (self.rms() * self.count as f64)
    }
}

/// Errors of one part of a session.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Errors {
    /// Position errors of all segments' ends, m².
    pub positions: Squares,
    /// Position errors of the last one, m².
    pub tips: Squares,
    /// Heading errors of all segments' ends, rad².
    pub headings: Squares,
}

impl Errors {
    /// Adds one sample of an arm of `segments`.
    pub fn add(&mut self, ends: &[End], segments: usize) {
        for (i, error) in ends.iter().enumerate().filter_map(|(i, end)| Some((i, end.error?))) {
            self.positions.add(error.point.norm_squared());
            self.headings.add(error.heading * error.heading);
            if i + 1 == segments {
                self.tips.add(error.point.norm_squared());
            }
        }
    }

    /// Adds the errors of another session.
    pub fn append(&mut self, other: &Self) {
        self.positions.append(other.positions);
        self.tips.append(other.tips);
        self.headings.append(other.headings);
    }

    /// RMSE of position plus RMSE of heading at a lever of `lever_m`, m.
    pub fn joint_m(&self, lever_m: f64) -> f64 {
        self.positions.rms() + lever_m * self.headings.rms()
    }

    /// The errors in the form of a table's record.
    pub fn keys(&self) -> RmseToml {
        RmseToml {
            position_rmse_mm: self.positions.rms() * 1e3,
            tip_rmse_mm: self.tips.rms() * 1e3,
            heading_rmse_deg: self.headings.rms().to_degrees(),
        }
    }
}

/// Errors of one session.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct SessionErrors {
    pub training: Errors,
    pub validation: Errors,
}
