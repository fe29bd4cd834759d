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

#[cfg(test)]
mod tests {
    use calibration_tables::{ArmFile, BendKeys, CurveKeys, PLANAR_6_ARM};
    use estimator_core::{BendMap, CurveMap, Estimator, Sample};
    use nalgebra::Vector4;

    use super::super::sweep::Sweep;
    use super::{features, keys};

    const LARGEST_RAD: f64 = 0.8;
    const WEIGHTS: Vector4<f64> = Vector4::new(0.3, -0.2, 0.25, -0.1);

    /// Two swings at once, with every seventh reading missing and a restart.
    fn sweep() -> Sweep {
        let phase = |row: usize, period_s: f64| libm::sin(row as f64 * 0.1 * std::f64::consts::TAU / period_s);
        let counts =
            |row: usize| (row % 7 != 3).then(|| (2000.0 + 500.0 * phase(row, 23.0) + 400.0 * phase(row, 3.7)) as u16);
        let runs = (0..2000).map(|row| u32::from(row >= 1200)).collect();
        Sweep::of_sensor(10.0, (0..2000).map(counts).collect(), vec![Some(0.0); 2000], runs)
    }

    fn curve() -> CurveKeys {
        CurveKeys { volts: [0.8, 2.4], theta_deg: (0..65).map(|k| f64::from(k * k) / 64.0 - 20.0).collect() }
    }

    /// The arm's first segment with this sensor.
    fn table() -> ArmFile {
        let mut table = ArmFile::parse(PLANAR_6_ARM).expect("it is committed");
        table.segments.truncate(1);
        table.segments[0].bend = Some(vec![BendKeys {
            c0: 0.0,
            c1: 1.0,
            c2: 0.0,
            rmse_deg: None,
            volts: None,
            curve: Some(curve()),
            memory: Some(keys(&WEIGHTS, LARGEST_RAD)),
        }]);
        table
    }

    #[test]
    fn the_features_are_those_of_the_estimator() {
        let sweep = sweep();
        let angles: Vec<f64> = curve().theta_deg.into_iter().map(f64::to_radians).collect();
        let map = BendMap::Curve(CurveMap::from_volts(&angles, curve().volts));
        let counts = &sweep.sensors[0].counts;
        let angles: Vec<Option<f64>> = counts.iter().map(|counts| map.angle((*counts)?)).collect();
        let features = features(&angles, &sweep, LARGEST_RAD);

        let baked = table().bake::<f64>(10.0).expect("it is a table");
        let config = baked.config();
        let mut estimator = Estimator::<f64, 1, 1000>::new(&config).expect("it has one segment");
        for (row, counts) in counts.iter().enumerate() {
            if row > 0 && sweep.runs[row] != sweep.runs[row - 1] {
                estimator.start().expect("it has one segment");
            }
            let sample = Sample { bend: [[*counts, None]], ..Sample::missing(sweep.time_us[row]) };
            let bend = estimator.update_full(&sample).segments[0].bend.map(|link| link.theta.rad());
            let expected = angles[row].zip(features[row]).map(|(angle, terms)| angle + WEIGHTS.dot(&terms));
            assert_eq!(bend.is_some(), expected.is_some(), "row {row}");
            if let Some((found, expected)) = bend.zip(expected) {
                // The estimator's memory works in fixed point, whatever its number is.
                assert!((found - expected).abs() < 2e-5, "row {row}: {found} and {expected} rad");
            }
        }
    }

    #[test]
    fn weights_that_made_the_data_are_found() {
        let sweep = sweep();
        let angles: Vec<_> =
            sweep.sensors[0].counts.iter().map(|counts| Some(f64::from((*counts)?) / 1000.0 - 2.0)).collect();
        let features = features(&angles, &sweep, LARGEST_RAD);
        let errors: Vec<_> = features.iter().map(|terms| Some(WEIGHTS.dot(&(*terms)?))).collect();
        let found = super::fit(&features, &errors).expect("four features").weights;
        assert!((found - WEIGHTS).amax() < 0.05, "{found}");
    }
}
