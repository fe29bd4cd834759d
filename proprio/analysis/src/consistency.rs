//! Consistency of the estimates' covariances with their errors against truth (NEES).

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{FusedOps, Method, SegmentShape, Shape, Uncertainties, Uncertainty, VARIANCE_SCALE};
use proprio_session::{CHI2_2_95, Row};
use serde::Serialize;

use crate::Outcome;

/// Squared errors, each divided by its covariance.
#[derive(Debug, Clone, Copy, Default)]
struct Normalised {
    sum: f64,
    inside: u64,
    count: u64,
}

impl Normalised {
    fn add(&mut self, square: f64) {
        self.sum += square;
        self.inside += u64::from(square <= CHI2_2_95);
        self.count += 1;
    }

    fn append(&mut self, other: &Self) {
        self.sum += other.sum;
        self.inside += other.inside;
        self.count += other.count;
    }

    /// The mean of `sum`; `None` without any value.
    fn of_count(&self, sum: f64) -> Option<f64> {
        (self.count > 0).then(|| sum / self.count as f64)
    }
}

/// Squared error of the tip over its covariance, where truth and covariance are known: χ² of two degrees of freedom where they are
/// consistent.
#[must_use]
pub fn tip_square<S: FusedOps>(
    row: &Row,
    shape: &Shape<S, MAX_SEGMENTS>,
    uncertainties: &Uncertainties<MAX_SEGMENTS>,
) -> Option<f64> {
    let tip = shape.len().checked_sub(1)?;
    end_square(row, tip, &shape[tip], uncertainties.get(tip)?)
}

/// The same of the end of segment `i`, from 0.
fn end_square<S: FusedOps>(row: &Row, i: usize, segment: &SegmentShape<S>, uncertainty: &Uncertainty) -> Option<f64> {
    let (end, truth, covariance) = (segment.end?, row.truth[i]?, uncertainty.end?);
    let [xx, xy, yy] = covariance.square_metres();
    let (dx, dy) = (end.x.to_f64() - truth.x_m, end.y.to_f64() - truth.y_m);
    Some((yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy))
}

/// Normalised errors of the fused or smoothed shape, gathered over one or more sessions.
#[derive(Debug, Clone, Copy, Default)]
pub struct FilterConsistency {
    tips: Normalised,
    ends: Normalised,
    thetas: Normalised,
}

/// Metrics of consistency; `None` where the table has no error sources, or there was no truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConsistencyMetrics {
    /// Mean normalised estimation error squared of the tip for each of its two coordinates: 1 is consistent, above 1 the filter is
    /// overconfident.
    pub tip_nees: Option<f64>,
    /// Share of the true tips within their 95 % ellipse, %.
    pub tip_inside_percent: Option<f64>,
    /// Mean normalised estimation error squared of the ends of all segments, for each coordinate.
    pub end_nees: Option<f64>,
    /// Share of the true ends of all segments within their 95 % ellipses, %.
    pub end_inside_percent: Option<f64>,
    /// Mean normalised estimation error squared of the bend angles.
    pub theta_nees: Option<f64>,
}

impl FilterConsistency {
    /// Adds the fused shape of one row, where it has truth and covariances.
    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        self.add_shape(row, &outcome.shapes[Method::Fusion as usize], &outcome.uncertainties);
    }

    /// Adds a shape, where it has truth and covariances.
    pub fn add_shape<S: FusedOps>(
        &mut self,
        row: &Row,
        shape: &Shape<S, MAX_SEGMENTS>,
        uncertainties: &Uncertainties<MAX_SEGMENTS>,
    ) {
        let count = shape.len();
        for (i, (segment, uncertainty)) in shape.iter().zip(uncertainties).enumerate() {
            let theta = segment.theta.zip(row.true_theta(i)).zip(uncertainty.theta);
            if let Some(((theta, truth), variance)) = theta {
                self.thetas.add((theta.rad() - truth).powi(2) * VARIANCE_SCALE / variance.to_f64());
            }
            if let Some(square) = end_square(row, i, segment, uncertainty) {
                self.ends.add(square);
                if i + 1 == count {
                    self.tips.add(square);
                }
            }
        }
    }

    /// Adds all errors of another session of the same arm.
    pub fn append(&mut self, other: &Self) {
        self.tips.append(&other.tips);
        self.ends.append(&other.ends);
        self.thetas.append(&other.thetas);
    }

    /// The metrics.
    #[must_use]
    pub fn metrics(&self) -> ConsistencyMetrics {
        let nees = |of: &Normalised| of.of_count(of.sum / 2.0);
        let inside_percent = |of: &Normalised| of.of_count(of.inside as f64 * 100.0);
        ConsistencyMetrics {
            tip_nees: nees(&self.tips),
            tip_inside_percent: inside_percent(&self.tips),
            end_nees: nees(&self.ends),
            end_inside_percent: inside_percent(&self.ends),
            theta_nees: self.thetas.of_count(self.thetas.sum),
        }
    }
}
