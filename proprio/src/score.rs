//! Errors against truth: world-frame tip distance and bend angle, by method.

use estimator_core::{FusedOps, Method};
use serde::Serialize;

use crate::distances::Distances;
use crate::honesty::{Honesty, HonestyFigures};
use crate::replay::Outcome;
use crate::session::Row;

/// Errors of one method, gathered over one or more sessions.
#[derive(Debug, Clone, Default)]
struct Errors {
    tips: Distances,
    theta_square_sum: f64,
    thetas: u64,
}

/// Errors of all methods.
#[derive(Debug, Clone)]
pub struct Score {
    length_m: f64,
    errors: [Errors; Method::ALL.len()],
    honesty: Honesty,
}

/// The figures of one method; `None` where it said nothing, or there was no truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Root mean square of the tip's distance to its true place, mm.
    pub tip_rmse_mm: Option<f64>,
    /// The same in % of the arm's length.
    pub tip_rmse_percent: Option<f64>,
    /// 75th percentile of the tip's distance, mm; to 10⁻⁴ of it.
    pub tip_p75_mm: Option<f64>,
    /// Root mean square error of the bend angles, over all segments, degrees.
    pub theta_rmse_deg: Option<f64>,
}

/// Distance of the tip from its true place by each of [`Method::ALL`], where both are known, m.
#[must_use]
pub fn tip_errors_m<S: FusedOps>(row: &Row, outcome: &Outcome<S>) -> [Option<f64>; Method::ALL.len()] {
    outcome.shapes.each_ref().map(|shape| {
        let tip = shape.last()?.end?;
        let truth = row.truth.get(shape.len() - 1).copied().flatten()?;
        let (dx, dy) = (tip.x.to_f64() - truth.x_m, tip.y.to_f64() - truth.y_m);
        Some((dx * dx + dy * dy).sqrt())
    })
}

impl Score {
    /// No errors yet, for an arm of `length_mm`.
    #[must_use]
    pub fn new(length_mm: f64) -> Self {
        Self { length_m: length_mm / 1e3, errors: Default::default(), honesty: Honesty::default() }
    }

    /// Adds one row, as far as it has truth.
    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        for (errors, shape) in self.errors.iter_mut().zip(&outcome.shapes) {
            for (i, segment) in shape.iter().enumerate() {
                if let Some((theta, truth)) = segment.theta.zip(row.true_theta(i)) {
                    errors.theta_square_sum += (theta.rad() - truth).powi(2);
                    errors.thetas += 1;
                }
            }
        }
        for (errors, tip_m) in self.errors.iter_mut().zip(tip_errors_m(row, outcome)) {
            if let Some(tip_m) = tip_m {
                errors.tips.add(tip_m);
            }
        }
        self.honesty.add(row, outcome);
    }

    /// Adds all errors of another session of the same arm.
    pub fn append(&mut self, other: &Self) {
        self.honesty.append(&other.honesty);
        for (errors, other) in self.errors.iter_mut().zip(&other.errors) {
            errors.tips.append(&other.tips);
            errors.theta_square_sum += other.theta_square_sum;
            errors.thetas += other.thetas;
        }
    }

    /// Distances of the tip from its true place by `method`.
    #[must_use]
    pub fn tips(&self, method: Method) -> &Distances {
        &self.errors[method as usize].tips
    }

    /// How honest the covariances were; `None` where there were none, or no truth.
    #[must_use]
    pub fn honesty(&self) -> Option<HonestyFigures> {
        let figures = self.honesty.figures();
        figures.end_nees.map(|_| figures)
    }

    /// The figures of each of [`Method::ALL`].
    #[must_use]
    pub fn figures(&self) -> [Figures; Method::ALL.len()] {
        self.errors.each_ref().map(|errors| {
            let tip_rmse_m = errors.tips.rms_m();
            let theta_mean_square = errors.theta_square_sum / errors.thetas as f64;
            Figures {
                tip_rmse_mm: tip_rmse_m.map(|m| m * 1e3),
                tip_rmse_percent: tip_rmse_m.map(|m| m / self.length_m * 100.0),
                tip_p75_mm: errors.tips.quantile_m(0.75).map(|m| m * 1e3),
                theta_rmse_deg: (errors.thetas > 0).then(|| theta_mean_square.sqrt().to_degrees()),
            }
        })
    }
}
