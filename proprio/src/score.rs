//! Errors against truth: world-frame tip distance and bend angle, by method.

use estimator_core::{Method, Scalar};
use serde::Serialize;

use crate::replay::Outcome;
use crate::session::Row;

/// Errors of one method, gathered over one or more sessions.
#[derive(Debug, Clone, Default)]
struct Errors {
    tips_m: Vec<f64>,
    theta_square_sum: f64,
    thetas: u64,
}

/// Errors of all methods.
#[derive(Debug, Clone)]
pub struct Score {
    length_m: f64,
    errors: [Errors; Method::ALL.len()],
}

/// The figures of one method; `None` where it said nothing, or there was no truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Root mean square of the tip's distance to its true place, mm.
    pub tip_rmse_mm: Option<f64>,
    /// The same in % of the arm's length.
    pub tip_rmse_percent: Option<f64>,
    /// 75th percentile of the tip's distance, mm.
    pub tip_p75_mm: Option<f64>,
    /// Root mean square error of the bend angles, over all segments, degrees.
    pub theta_rmse_deg: Option<f64>,
}

impl Score {
    /// No errors yet, for an arm of `length_mm`.
    #[must_use]
    pub fn new(length_mm: f64) -> Self {
        Self { length_m: length_mm / 1e3, errors: Default::default() }
    }

    /// Adds one row, as far as it has truth.
    pub fn add<S: Scalar>(&mut self, row: &Row, outcome: &Outcome<S>) {
        for (errors, shape) in self.errors.iter_mut().zip(&outcome.shapes) {
            for (i, segment) in shape.iter().enumerate() {
                if let Some((theta, truth)) = segment.theta.zip(row.true_theta(i)) {
                    errors.theta_square_sum += (theta.rad() - truth).powi(2);
                    errors.thetas += 1;
                }
            }
            let tip = shape.last().and_then(|segment| segment.end);
            if let Some((tip, truth)) = tip.zip(row.truth.get(shape.len().wrapping_sub(1)).copied().flatten()) {
                let (dx, dy) = (tip.x.to_f64() - truth.x_m, tip.y.to_f64() - truth.y_m);
                errors.tips_m.push((dx * dx + dy * dy).sqrt());
            }
        }
    }

    /// Adds all errors of another session of the same arm.
    pub fn append(&mut self, other: &Self) {
        for (errors, other) in self.errors.iter_mut().zip(&other.errors) {
            errors.tips_m.extend_from_slice(&other.tips_m);
            errors.theta_square_sum += other.theta_square_sum;
            errors.thetas += other.thetas;
        }
    }

    /// The figures of each of [`Method::ALL`].
    #[must_use]
    pub fn figures(&self) -> [Figures; Method::ALL.len()] {
        self.errors.each_ref().map(|errors| {
            let tip_rmse_m = rms(errors.tips_m.iter().map(|d| d * d).sum(), errors.tips_m.len());
            Figures {
                tip_rmse_mm: tip_rmse_m.map(|m| m * 1e3),
                tip_rmse_percent: tip_rmse_m.map(|m| m / self.length_m * 100.0),
                tip_p75_mm: quantile(errors.tips_m.clone(), 0.75).map(|m| m * 1e3),
                theta_rmse_deg: rms(errors.theta_square_sum, errors.thetas as usize).map(f64::to_degrees),
            }
        })
    }
}

fn rms(square_sum: f64, count: usize) -> Option<f64> {
    (count > 0).then(|| (square_sum / count as f64).sqrt())
}

/// The quantile between the two nearest values, linearly interpolated.
fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    values.sort_unstable_by(f64::total_cmp);
    let place = share * last as f64;
    let below = place.floor() as usize;
    let [lo, hi] = [below, (below + 1).min(last)].map(|i| values[i]);
    Some(lo + (hi - lo) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn a_quantile_lies_between_its_neighbours() {
        assert_eq!(quantile(vec![4.0, 1.0, 3.0, 2.0], 0.75), Some(3.25));
        assert_eq!(quantile(vec![7.0], 0.75), Some(7.0));
        assert_eq!(quantile(Vec::new(), 0.75), None);
    }
}
