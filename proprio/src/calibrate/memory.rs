//! Memory of a bend sensor: weights of two lags and two plays, by ridge regression.
//!
//! The features are computed by the recursion of `estimator-core`'s `sensing/hysteresis.rs`.

use calibration_tables::MemoryKeys;
use estimator_core::TIME_UNIT_S;
use nalgebra::{Matrix4, Vector4};

use super::folds::{FOLDS, fold};
use super::sweep::Sweep;

/// Time constants of the lags, s: a bend sensor creeps within seconds and within a minute. A lag of several minutes cannot be
/// told from drift in a sweep of a quarter of an hour.
const LAG_S: [f64; 2] = [4.0, 40.0];
/// Radii of the plays, shares of the largest bend angle.
const PLAY_SHARES: [f64; 2] = [0.1, 0.3];
/// Ridge parameters that are tried, for features of unit variance.
const RIDGES: [f64; 4] = [1e-3, 1e-2, 1e-1, 1.0];
/// Largest weight of the table's format.
const MAX_WEIGHT: f64 = 4.0;

/// Differences of the angle and each lag and play, rad.
pub(super) type Features = Vec<Option<Vector4<f64>>>;

/// Weights fitted to all rows, and those that were fitted without one tenth each.
pub(super) struct FittedMemory {
    pub weights: Vector4<f64>,
    pub held_back: [Vector4<f64>; FOLDS],
}

/// Sums of the normal equations over some rows.
#[derive(Clone, Copy, Default)]
struct Sums {
    normal: Matrix4<f64>,
    right: Vector4<f64>,
    square: f64,
    count: f64,
}

/// The table's keys with these weights, for bend angles up to `largest_rad`.
pub(super) fn keys(weights: &Vector4<f64>, largest_rad: f64) -> MemoryKeys {
    MemoryKeys {
        lag_s: LAG_S,
        lag_weight: [weights.x, weights.y],
        play_deg: PLAY_SHARES.map(|share| share * largest_rad.to_degrees()),
        play_weight: [weights.z, weights.w],
    }
}

/// The features of a column of angles; the memory starts at the first reading of each run.
pub(super) fn features(angles: &[Option<f64>], sweep: &Sweep, largest_rad: f64) -> Features {
    let radii = keys(&Vector4::zeros(), largest_rad).play_deg.map(f64::to_radians);
    let rates = LAG_S.map(|lag_s| TIME_UNIT_S / lag_s);
    let mut state: Option<([f64; 4], u64, u32)> = None;
    let rows = angles.iter().zip(&sweep.time_us).zip(&sweep.runs);
    let features = rows.map(|((angle, time_us), run)| {
        let theta = (*angle)?;
        let (outputs, read_at_us, _) = match &mut state {
            Some(state) if state.2 == *run => state,
            other => other.insert(([theta; 4], *time_us, *run)),
        };
        let dt = (time_us.saturating_sub(*read_at_us)).min(u64::from(u32::MAX)) as f64 * (1e-6 / TIME_UNIT_S);
        *read_at_us = *time_us;
        for (output, rate) in outputs.iter_mut().zip(rates) {
            let share = if dt < 1.0 / rate { rate * dt } else { 1.0 };
            *output += share * (theta - *output);
        }
        for (output, radius) in outputs[2..].iter_mut().zip(radii) {
            *output = theta - (theta - *output).clamp(-radius, radius);
        }
        Some(Vector4::from(outputs.map(|output| theta - output)))
    });
    features.collect()
}

/// Fits the weights to what a map leaves, `errors` = truth − angle; `None` where the features do not determine them.
pub(super) fn fit(features: &Features, errors: &[Option<f64>]) -> Option<FittedMemory> {
    let scale = deviations(features).map(|deviation| if deviation > 0.0 { 1.0 / deviation } else { 0.0 });
    let mut folds = [Sums::default(); FOLDS];
    for (row, (terms, error)) in features.iter().zip(errors).enumerate() {
        if let Some((terms, error)) = terms.zip(*error) {
            folds[fold(row, features.len())].add(terms.component_mul(&scale), error);
        }
    }
    let all = folds.iter().fold(Sums::default(), |all, fold| all.plus(fold, 1.0));
    let candidates = RIDGES.iter().filter_map(|ridge| {
        let weights = all.solve(*ridge)?;
        let held_back = folds.iter().map(|fold| all.plus(fold, -1.0).solve(*ridge)).collect::<Option<Vec<_>>>()?;
        let error: f64 = folds.iter().zip(&held_back).map(|(fold, weights)| fold.square_error(weights)).sum();
        let fits = weights.component_mul(&scale).amax() <= MAX_WEIGHT;
        fits.then_some((error, weights, held_back))
    });
    let (_, weights, held_back) = candidates.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(FittedMemory {
        weights: weights.component_mul(&scale),
        held_back: std::array::from_fn(|fold| held_back[fold].component_mul(&scale)),
    })
}

fn deviations(features: &Features) -> Vector4<f64> {
    let count = features.iter().flatten().count().max(1) as f64;
    let mean = features.iter().flatten().sum::<Vector4<f64>>() / count;
    let squares = features.iter().flatten().map(|terms| (terms - mean).map(|difference| difference * difference));
    (squares.sum::<Vector4<f64>>() / count).map(f64::sqrt)
}

impl Sums {
    fn add(&mut self, terms: Vector4<f64>, error: f64) {
        self.normal += terms * terms.transpose();
        self.right += terms * error;
        self.square += error * error;
        self.count += 1.0;
    }

    /// The sums with `sign` times those of `other`.
    fn plus(&self, other: &Self, sign: f64) -> Self {
        Self {
            normal: self.normal + other.normal * sign,
            right: self.right + other.right * sign,
            square: self.square + other.square * sign,
            count: self.count + other.count * sign,
        }
    }

    fn solve(&self, ridge: f64) -> Option<Vector4<f64>> {
        let normal = self.normal + Matrix4::identity() * (ridge * self.count);
        Some(normal.cholesky()?.solve(&self.right))
    }

    /// Sum of the squared errors that the weights leave.
    fn square_error(&self, weights: &Vector4<f64>) -> f64 {
        self.square - 2.0 * self.right.dot(weights) + weights.dot(&(self.normal * weights))
    }
}
