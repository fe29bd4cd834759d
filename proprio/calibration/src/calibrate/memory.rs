//! Memory of a bend sensor: weights of a lag and a play, by least squares.
//!
//! The features are computed by the recursion of `estimator-core`'s `sensing/hysteresis.rs`. The table's format has two lags and
//! two plays; calibration uses one of each. In a sweep with periods of 20 to 40 s a lag of as many seconds is collinear with the
//! slope of the map, and one play nearly with another: their weights become large and opposed, and are wrong where the arm
//! stays bent for minutes.

use calibration_tables::MemoryToml;
use nalgebra::{Matrix2, Vector2};

use super::folds::{FOLDS, fold};
use super::sweep::Sweep;

/// Time constant of the lag, s: a bend sensor creeps, or overshoots, within seconds. Half a sweep's period is three times
/// as long, so that the lag can be separated from the map.
const LAG_S: f64 = 4.0;
/// Radius of the play, a share of the largest bend angle. Shares from 0.1 to 0.2 are equally good on the simulated arms.
const PLAY_SHARE: f64 = 0.15;
/// Time constant of the format's second lag, s, which has no weight.
const UNUSED_LAG_S: f64 = 40.0;
/// Largest weight of the table's format.
const MAX_WEIGHT: f64 = 4.0;

/// Differences of the angle and its lag and play, rad.
pub(super) type Features = Vec<Option<Vector2<f64>>>;

/// Weights fitted to all rows, and those that were fitted without one tenth each.
pub(super) struct FittedMemory {
    pub weights: Vector2<f64>,
    pub held_back: [Vector2<f64>; FOLDS],
}

/// Sums of the normal equations over some rows.
#[derive(Clone, Copy, Default)]
struct Sums {
    normal: Matrix2<f64>,
    right: Vector2<f64>,
}

/// Outputs of the lag and the play at one reading.
struct State {
    lag: f64,
    play: f64,
    read_at_us: u64,
    run: u32,
}

/// The table's keys with these weights, for bend angles up to `largest_rad`.
pub(super) fn keys(weights: &Vector2<f64>, largest_rad: f64) -> MemoryToml {
    MemoryToml {
        lag_s: [LAG_S, UNUSED_LAG_S],
        lag_weight: [weights.x, 0.0],
        play_deg: [(PLAY_SHARE * largest_rad).to_degrees(); 2],
        play_weight: [weights.y, 0.0],
    }
}

/// The features of a column of angles; the memory starts at the first reading of each run.
pub(super) fn features(angles: &[Option<f64>], sweep: &Sweep, largest_rad: f64) -> Features {
    let radius = PLAY_SHARE * largest_rad;
    let mut state: Option<State> = None;
    let rows = angles.iter().zip(&sweep.time_us).zip(&sweep.runs);
    let features = rows.map(|((angle, time_us), run)| {
        let theta = (*angle)?;
        let state = match &mut state {
            Some(state) if state.run == *run => state,
            other => other.insert(State { lag: theta, play: theta, read_at_us: *time_us, run: *run }),
        };
        let elapsed_us = time_us.saturating_sub(state.read_at_us).min(u64::from(u32::MAX));
        state.read_at_us = *time_us;
        state.lag += (elapsed_us as f64 * 1e-6 / LAG_S).min(1.0) * (theta - state.lag);
        state.play = theta - (theta - state.play).clamp(-radius, radius);
        Some(Vector2::new(theta - state.lag, theta - state.play))
    });
    features.collect()
}

/// Fits the weights to the residual of a map, `errors` = truth − angle; `None` where the features do not determine them.
pub(super) fn fit(features: &Features, errors: &[Option<f64>]) -> Option<FittedMemory> {
    let mut folds = [Sums::default(); FOLDS];
    for (row, (terms, error)) in features.iter().zip(errors).enumerate() {
        if let Some((terms, error)) = terms.zip(*error) {
            let sums = &mut folds[fold(row, features.len())];
            sums.normal += terms * terms.transpose();
            sums.right += terms * error;
        }
    }
    let mut held_back = [Vector2::zeros(); FOLDS];
    for (left_out, weights) in held_back.iter_mut().enumerate() {
        let others = folds.iter().enumerate().filter(|(fold, _)| *fold != left_out);
        *weights = solve(others.map(|(_, sums)| sums))?;
    }
    Some(FittedMemory { weights: solve(folds.iter())?, held_back })
}

/// Weights of least squares over these sums; `None` where they are not determined, or beyond the table's format.
fn solve<'s>(sums: impl Iterator<Item = &'s Sums>) -> Option<Vector2<f64>> {
    let add = |a: Sums, b: &Sums| Sums { normal: a.normal + b.normal, right: a.right + b.right };
    let Sums { normal, right } = sums.fold(Sums::default(), add);
    let weights = normal.cholesky()?.solve(&right);
    (weights.amax() <= MAX_WEIGHT).then_some(weights)
}

#[cfg(test)]
mod tests {
    use calibration_tables::{ArmFile, BendToml, CurveToml, PLANAR_6_ARM};
    use estimator_core::{BendMap, CurveMap, Estimator, Sample};
    use nalgebra::Vector2;

    use super::super::sweep::Sweep;
    use super::{features, keys};

    const LARGEST_RAD: f64 = 0.8;
    const WEIGHTS: Vector2<f64> = Vector2::new(-0.2, 0.25);

    /// Two swings at once, with every seventh reading missing and a restart.
    fn sweep() -> Sweep {
        let phase = |row: usize, period_s: f64| libm::sin(row as f64 * 0.1 * std::f64::consts::TAU / period_s);
        let counts =
            |row: usize| (row % 7 != 3).then(|| (2000.0 + 500.0 * phase(row, 23.0) + 400.0 * phase(row, 3.7)) as u16);
        let runs = (0..2000).map(|row| u32::from(row >= 1200)).collect();
        Sweep::of_sensor(10.0, (0..2000).map(counts).collect(), vec![Some(0.0); 2000], runs)
    }

    fn curve() -> CurveToml {
        CurveToml { volts: [0.8, 2.4], theta_deg: (0..65).map(|k| f64::from(k * k) / 64.0 - 20.0).collect() }
    }

    /// The arm's first segment with this sensor.
    fn table() -> ArmFile {
        let mut table = ArmFile::parse(PLANAR_6_ARM).expect("it is committed");
        table.segments.truncate(1);
        table.segments[0].bend = Some(vec![BendToml {
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

        let compiled = table().compile::<f64>(10.0).expect("it is a table");
        let config = compiled.config();
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
                // The estimator's memory works in fixed point with any number type.
                assert!((found - expected).abs() < 2e-5, "row {row}: {found} and {expected} rad");
            }
        }
    }

    #[test]
    fn the_weights_that_made_the_data_are_found() {
        let sweep = sweep();
        let angles: Vec<_> =
            sweep.sensors[0].counts.iter().map(|counts| Some(f64::from((*counts)?) / 1000.0 - 2.0)).collect();
        let features = features(&angles, &sweep, LARGEST_RAD);
        let errors: Vec<_> = features.iter().map(|terms| Some(WEIGHTS.dot(&(*terms)?))).collect();
        let found = super::fit(&features, &errors).expect("it moves").weights;
        assert!((found - WEIGHTS).amax() < 1e-9, "{found}");
    }

    #[test]
    fn a_sensor_that_does_not_move_gets_no_memory() {
        assert!(super::fit(&vec![Some(Vector2::zeros()); 2000], &vec![Some(0.1); 2000]).is_none());
    }

    /// Swings for half a minute, then a lean of three minutes.
    #[test]
    fn in_a_lean_the_lag_is_gone_and_the_play_is_no_more_than_its_radius() {
        let still = |row: usize| if row < 300 { 0.8 * libm::sin(0.05 * row as f64) } else { 0.8 };
        let angles: Vec<_> = (0..2000).map(|row| Some(still(row))).collect();
        let mut sweep = sweep();
        sweep.runs.fill(0);
        let last = features(&angles, &sweep, LARGEST_RAD).last().copied().flatten().expect("it is read");
        assert!(last.x.abs() < 1e-6 && last.y <= super::PLAY_SHARE * LARGEST_RAD + 1e-12, "{last}");
    }
}
