//! Errors against truth: world-frame tip distance and bend angle, by method.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{FusedOps, Method, Shape};
use proprio_session::Row;
use serde::Serialize;

use crate::Outcome;
use crate::consistency::{ConsistencyMetrics, FilterConsistency};
use crate::error_histogram::ErrorHistogram;
use crate::smooth::Smoothed;

/// Errors of one method, gathered over one or more sessions.
#[derive(Debug, Clone, Default)]
struct Errors {
    tips: ErrorHistogram,
    theta_square_sum: f64,
    thetas: u64,
}

/// Errors of all methods, and of the smoothed shape.
#[derive(Debug, Clone)]
pub struct ErrorMetrics {
    length_m: f64,
    errors: [Errors; Method::ALL.len()],
    consistency: FilterConsistency,
    smoothed: Errors,
    smoothed_consistency: FilterConsistency,
}

/// The metrics of one method; `None` where it had no estimate, or there was no truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metrics {
    /// Root mean square of the tip's distance to its true place, mm.
    pub tip_rmse_mm: Option<f64>,
    /// Root mean square of the tip's distance, % of the arm's length.
    pub tip_rmse_percent: Option<f64>,
    /// 75th percentile of the tip's distance, mm; to 10⁻⁴ of it.
    pub tip_p75_mm: Option<f64>,
    /// Root mean square error of the bend angles, over all segments, degrees.
    pub theta_rmse_deg: Option<f64>,
}

/// The metrics of the smoothed shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SmoothedMetrics {
    /// Its errors.
    #[serde(flatten)]
    pub metrics: Metrics,
    /// Consistency of its covariances, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<ConsistencyMetrics>,
}

/// Distance of the tip from its true place by each of [`Method::ALL`], where both are known, m.
#[must_use]
pub fn tip_errors_m<S: FusedOps>(row: &Row, outcome: &Outcome<S>) -> [Option<f64>; Method::ALL.len()] {
    outcome.shapes.each_ref().map(|shape| tip_error_m(row, shape))
}

/// Distance of the smoothed tip from its true place, where both are known, m.
#[must_use]
pub fn smoothed_tip_error_m<S: FusedOps>(row: &Row, outcome: &Outcome<S>) -> Option<f64> {
    tip_error_m(row, &outcome.smoothed.as_ref()?.shape)
}

fn tip_error_m<S: FusedOps>(row: &Row, shape: &Shape<S, MAX_SEGMENTS>) -> Option<f64> {
    let tip = shape.last()?.end?;
    let truth = row.truth.get(shape.len() - 1).copied().flatten()?;
    let (dx, dy) = (tip.x.to_f64() - truth.x_m, tip.y.to_f64() - truth.y_m);
    Some((dx * dx + dy * dy).sqrt())
}

impl Errors {
    fn add<S: FusedOps>(&mut self, row: &Row, shape: &Shape<S, MAX_SEGMENTS>) {
        for (i, segment) in shape.iter().enumerate() {
            if let Some((theta, truth)) = segment.theta.zip(row.true_theta(i)) {
                self.theta_square_sum += (theta.rad() - truth).powi(2);
                self.thetas += 1;
            }
        }
        if let Some(tip_m) = tip_error_m(row, shape) {
            self.tips.add(tip_m);
        }
    }

    fn append(&mut self, other: &Self) {
        self.tips.append(&other.tips);
        self.theta_square_sum += other.theta_square_sum;
        self.thetas += other.thetas;
    }

    fn metrics(&self, length_m: f64) -> Metrics {
        let tip_rmse_m = self.tips.rms_m();
        let theta_mean_square = self.theta_square_sum / self.thetas as f64;
        Metrics {
            tip_rmse_mm: tip_rmse_m.map(|m| m * 1e3),
            tip_rmse_percent: tip_rmse_m.map(|m| m / length_m * 100.0),
            tip_p75_mm: self.tips.quantile_m(0.75).map(|m| m * 1e3),
            theta_rmse_deg: (self.thetas > 0).then(|| theta_mean_square.sqrt().to_degrees()),
        }
    }
}

impl ErrorMetrics {
    /// No errors yet, for an arm of `length_mm`.
    #[must_use]
    pub fn new(length_mm: f64) -> Self {
        Self {
            length_m: length_mm / 1e3,
            errors: Default::default(),
            consistency: FilterConsistency::default(),
            smoothed: Errors::default(),
            smoothed_consistency: FilterConsistency::default(),
        }
    }

    /// Adds one row, where it has truth.
    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        for (errors, shape) in self.errors.iter_mut().zip(&outcome.shapes) {
            errors.add(row, shape);
        }
        self.consistency.add(row, outcome);
        if let Some(Smoothed { shape, uncertainties }) = &outcome.smoothed {
            self.smoothed.add(row, shape);
            self.smoothed_consistency.add_shape(row, shape, uncertainties);
        }
    }

    /// Adds all errors of another session of the same arm.
    pub fn append(&mut self, other: &Self) {
        self.consistency.append(&other.consistency);
        self.smoothed_consistency.append(&other.smoothed_consistency);
        self.smoothed.append(&other.smoothed);
        for (errors, other) in self.errors.iter_mut().zip(&other.errors) {
            errors.append(other);
        }
    }

    /// Distances of the tip from its true place by `method`.
    #[must_use]
    pub fn tips(&self, method: Method) -> &ErrorHistogram {
        &self.errors[method as usize].tips
    }

    /// Consistency of the covariances; `None` without covariances or truth.
    #[must_use]
    pub fn consistency(&self) -> Option<ConsistencyMetrics> {
        let metrics = self.consistency.metrics();
        metrics.end_nees.map(|_| metrics)
    }

    /// The metrics of each of [`Method::ALL`].
    #[must_use]
    pub fn metrics(&self) -> [Metrics; Method::ALL.len()] {
        self.errors.each_ref().map(|errors| errors.metrics(self.length_m))
    }

    /// Distances of the smoothed tip from its true place.
    #[must_use]
    pub fn smoothed_tips(&self) -> &ErrorHistogram {
        &self.smoothed.tips
    }

    /// The metrics of the smoothed shape; `None` where nothing was smoothed, or there was no truth.
    #[must_use]
    pub fn smoothed(&self) -> Option<SmoothedMetrics> {
        let has_truth = self.smoothed.tips.count() > 0 || self.smoothed.thetas > 0;
        has_truth.then(|| {
            let uncertainty = Some(self.smoothed_consistency.metrics()).filter(|metrics| metrics.end_nees.is_some());
            SmoothedMetrics { metrics: self.smoothed.metrics(self.length_m), uncertainty }
        })
    }
}
