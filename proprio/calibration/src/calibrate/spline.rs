//! Penalised cubic spline (P-spline, Eilers and Marx 1996) of bend angle over voltage, made monotone.
//!
//! B-splines on evenly spaced knots, a penalty on the third differences of their coefficients. The penalty is the one with
//! the smallest held-back error: each tenth of the sweep is predicted from the others.

use calibration_tables::CurveToml;
use nalgebra::{SMatrix, SVector};

use super::folds::{FOLDS, Observation};
use super::statistics::quantile;

/// Intervals between the knots.
const INTERVALS: usize = 16;
const BASIS: usize = INTERVALS + 3;
/// Points of the table's curve.
const POINTS: usize = 65;
/// Penalties that are tried, for a sweep at 10 Hz.
const PENALTIES: [f64; 9] = [1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5];
/// Held-back square errors within this factor of the smallest are a tie, which the smoother curve wins.
const TIE: f64 = 1.005;
/// Ridge that keeps the normal equations definite where there is no reading.
const RIDGE: f64 = 1e-6;
/// Quantiles of the voltage between which the spline is fitted.
const QUANTILES: [f64; 2] = [0.0005, 0.9995];
/// Range of voltage that a curve needs at least, V: that of a sensor that is not dead.
const LEAST_VOLTS: f64 = 0.016;

type Normal = SMatrix<f64, BASIS, BASIS>;
type Coefficients = SVector<f64, BASIS>;

/// A curve fitted to all observations, and those that were fitted without one tenth each.
pub(super) struct FittedCurve {
    pub curve: CurveToml,
    pub held_back: [CurveToml; FOLDS],
}

/// Sums of the normal equations over some observations.
#[derive(Clone, Copy)]
struct Sums {
    normal: Normal,
    right: Coefficients,
    square: f64,
}

/// Fits angles (rad) over voltage (V) at this sample rate; `None` where the voltage hardly changes.
pub(super) fn fit(observations: &[Observation], rate_hz: f64) -> Option<FittedCurve> {
    let volts @ [lo, hi] = voltage_range(observations)?;
    let mut folds = vec![Sums::ZERO; FOLDS];
    for observation in observations {
        folds[observation.fold].add(observation, volts);
    }
    let all = folds.iter().fold(Sums::ZERO, |all, fold| all.plus(fold, 1.0));
    let penalty = third_differences();
    let solve = |sums: &Sums, factor: f64| sums.solve(&penalty, factor * rate_hz / 10.0);
    let held_back =
        |factor: f64| folds.iter().map(|fold| solve(&all.plus(fold, -1.0), factor)).collect::<Option<Vec<_>>>();

    let fits = PENALTIES.iter().filter_map(|factor| {
        let coefficients = held_back(*factor)?;
        let error: f64 = folds.iter().zip(&coefficients).map(|(fold, c)| fold.square_error(c)).sum();
        Some((*factor, coefficients, error))
    });
    let fits: Vec<_> = fits.collect();
    let smallest = fits.iter().map(|(_, _, error)| *error).fold(f64::INFINITY, f64::min);
    let (factor, held_back, _) = fits.iter().rev().find(|(_, _, error)| *error <= smallest * TIE)?;
    let curve = |coefficients: &Coefficients| curve(coefficients, [lo, hi]);
    Some(FittedCurve {
        curve: curve(&solve(&all, *factor)?),
        held_back: std::array::from_fn(|fold| curve(&held_back[fold])),
    })
}

/// Lowest and highest voltage of the curve.
fn voltage_range(observations: &[Observation]) -> Option<[f64; 2]> {
    let mut volts: Vec<f64> = observations.iter().map(|observation| observation.volts).collect();
    volts.sort_unstable_by(f64::total_cmp);
    // Rounded as in the table.
    let [lo, hi] = QUANTILES.map(|share| rounded(quantile(&volts, share), 1e6));
    (hi - lo > LEAST_VOLTS).then_some([lo, hi])
}

fn rounded(value: f64, digits: f64) -> f64 {
    (value * digits).round() / digits
}

/// Index of the first of the four B-splines that are not zero at a voltage, and the four.
fn basis(volts: f64, [lo, hi]: [f64; 2]) -> (usize, [f64; 4]) {
    let place = ((volts - lo) / (hi - lo)).clamp(0.0, 1.0) * INTERVALS as f64;
    let first = (place as usize).min(INTERVALS - 1);
    let t = place - first as f64;
    let s = 1.0 - t;
    let splines = [
        s * s * s / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        t * t * t / 6.0,
    ];
    (first, splines)
}

/// DᵀD of the third differences D.
fn third_differences() -> Normal {
    const DIFFERENCE: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    let mut penalty = Normal::zeros();
    for row in 0..BASIS - 3 {
        for (i, a) in DIFFERENCE.iter().enumerate() {
            for (j, b) in DIFFERENCE.iter().enumerate() {
                penalty[(row + i, row + j)] += a * b;
            }
        }
    }
    penalty
}

impl Sums {
    const ZERO: Self = Self {
        normal: Normal::from_array_storage(nalgebra::ArrayStorage([[0.0; BASIS]; BASIS])),
        right: ZEROS,
        square: 0.0,
    };

    fn add(&mut self, observation: &Observation, volts: [f64; 2]) {
        let (first, splines) = basis(observation.volts, volts);
        for (i, a) in splines.iter().enumerate() {
            for (j, b) in splines.iter().enumerate() {
                self.normal[(first + i, first + j)] += a * b;
            }
            self.right[first + i] += a * observation.theta;
        }
        self.square += observation.theta * observation.theta;
    }

    /// The sums with `sign` times those of `other`.
    fn plus(&self, other: &Self, sign: f64) -> Self {
        Self {
            normal: self.normal + other.normal * sign,
            right: self.right + other.right * sign,
            square: self.square + other.square * sign,
        }
    }

    fn solve(&self, penalty: &Normal, factor: f64) -> Option<Coefficients> {
        let normal = self.normal + penalty * factor + Normal::identity() * RIDGE;
        Some(normal.cholesky()?.solve(&self.right))
    }

    /// Sum of the squared errors with these coefficients.
    fn square_error(&self, coefficients: &Coefficients) -> f64 {
        let mut explained = 0.0;
        for (i, c) in coefficients.iter().enumerate() {
            explained += c * (2.0 * self.right[i] - self.normal.column(i).dot(coefficients));
        }
        (self.square - explained).max(0.0)
    }
}

const ZEROS: Coefficients = Coefficients::from_array_storage(nalgebra::ArrayStorage([[0.0; BASIS]; 1]));

/// The spline at evenly spaced voltages, made monotone; in steps of 10⁻⁴ degrees.
fn curve(coefficients: &Coefficients, volts: [f64; 2]) -> CurveToml {
    let [lo, hi] = volts;
    let theta = |k: usize| {
        let (first, splines) = basis(lo + (hi - lo) * k as f64 / (POINTS - 1) as f64, volts);
        splines.iter().enumerate().map(|(i, spline)| spline * coefficients[first + i]).sum::<f64>()
    };
    let points: Vec<f64> = (0..POINTS).map(theta).collect();
    let theta_deg = monotone(&points).into_iter().map(|theta| rounded(theta.to_degrees(), 1e4)).collect();
    CurveToml { volts, theta_deg }
}

/// The nearest monotone values by the sum of squares (pool adjacent violators); the ends determine the direction.
fn monotone(values: &[f64]) -> Vec<f64> {
    let sign = if values.last() >= values.first() { 1.0 } else { -1.0 };
    // Means of blocks that rise, and the blocks' lengths.
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    for value in values {
        let (mut mean, mut length) = (sign * value, 1);
        while let Some((before, count)) = blocks.pop_if(|(before, _)| *before > mean) {
            mean = (mean * length as f64 + before * count as f64) / (length + count) as f64;
            length += count;
        }
        blocks.push((mean, length));
    }
    blocks.into_iter().flat_map(|(mean, length)| std::iter::repeat_n(sign * mean, length)).collect()
}

#[cfg(test)]
mod tests {
    use super::{FOLDS, Observation, fit, monotone};

    fn observations(theta: impl Fn(f64) -> f64) -> Vec<Observation> {
        let observation = |k: usize| {
            let volts = 1.5 + libm::sin(0.01 * k as f64);
            Observation { row: k, volts, theta: theta(volts), fold: k * FOLDS / 4000 }
        };
        (0..4000).map(observation).collect()
    }

    #[test]
    fn a_rippled_curve_is_followed() {
        let theta = |v: f64| 0.8 * (v - 1.5) + 0.03 * libm::sin(12.0 * v);
        let fitted = fit(&observations(theta), 10.0).expect("2 V of range");
        for k in 0..=20 {
            let volts = 0.55 + 1.9 * f64::from(k) / 20.0;
            let error_deg = (fitted.curve.angle(volts) - theta(volts)).to_degrees();
            assert!(error_deg.abs() < 0.1, "{error_deg}° at {volts} V");
        }
    }

    #[test]
    fn a_curve_that_turns_back_becomes_level_there() {
        assert_eq!(monotone(&[0.0, 3.0, 1.0, 2.0, 5.0]), [0.0, 2.0, 2.0, 2.0, 5.0]);
        assert_eq!(monotone(&[5.0, 2.0, 4.0, 0.0]), [5.0, 3.0, 3.0, 0.0]);
    }

    #[test]
    fn one_voltage_makes_no_curve() {
        let level: Vec<_> = observations(|v| v).into_iter().map(|one| Observation { volts: 1.0, ..one }).collect();
        assert!(fit(&level, 10.0).is_none());
    }
}
