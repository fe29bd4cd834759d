//! One Kalman filter against the matrices of the textbooks.

use estimator_core::{COVARIANCE_LIMIT, FusedOps, H_LIMIT, KalmanFilter, KalmanGains, KalmanParams, Q};
use nalgebra::{Matrix2, Matrix4, Matrix4x2, SVector, Vector2, Vector4};
use proptest::prelude::*;

/// h, r and z of one measurement.
type Measurement = (f64, f64, Vector2<f64>);

fn point(x: f64, y: f64) -> SVector<f64, 2> {
    SVector::from([x, y])
}

/// Parameters for a Q, and h and r of the IMU and of the bend sensors.
fn gains<S: FusedOps>(q: f64, imu: (f64, f64), bend: (f64, f64)) -> KalmanGains<S> {
    let [q, h_imu, r_imu, h_bend, r_bend] = [q, imu.0, imu.1, bend.0, bend.1].map(S::from_f64);
    KalmanGains::new(&KalmanParams { q, r_imu, r_bend, h_imu, h_bend })
}

/// Parameters for a Q, and h and r of one sensor, whichever that is.
fn alone<S: FusedOps>(q: f64, h: f64, r: f64) -> KalmanGains<S> {
    gains(q, (h, r), (h, r))
}

/// A filter that was started at a point with this covariance.
fn started(x: Vector2<f64>, p: f64) -> KalmanFilter<f64, 2> {
    let mut filter = KalmanFilter::new();
    filter.step(&alone(0.0, 1.0, p), Some(x), None);
    filter
}

fn scalar(filter: &KalmanFilter<f64, 1>) -> (f64, f64) {
    let (x, p) = filter.state().expect("it was measured");
    (x.x, p)
}

prop_compose! {
    fn measurement()(h in 0.5..2.0, r in 0.01..30.0, x in -2.0..2.0, y in -2.0..2.0) -> Measurement {
        (h, r, point(x, y))
    }
}

proptest! {
    /// KF_coord by the book: both measurements stacked, K = P⁻Hᵀ(H P⁻ Hᵀ + R)⁻¹. Only floats' rounding differs, grown
    /// by the square of the matrix's condition, up to 6000.
    #[test]
    fn a_step_is_the_book_s_with_both_measurements_stacked(
        p in 0.01..8.0, q in 0.0..8.0, imu in measurement(), bend in measurement()
    ) {
        let x = point(0.3, -0.2);
        let mut filter = started(x, p);
        let ((h1, r1, z1), (h2, r2, z2)) = (imu, bend);
        filter.step(&gains(q, (h1, r1), (h2, r2)), Some(z1), Some(z2));
        let (state, covariance) = filter.state().expect("it was measured");

        let h = Matrix4x2::new(h1, 0.0, 0.0, h1, h2, 0.0, 0.0, h2);
        let r = Matrix4::from_diagonal(&Vector4::new(r1, r1, r2, r2));
        let z = Vector4::new(z1.x, z1.y, z2.x, z2.y);
        let p = Matrix2::identity() * (p + q);
        let gain = p * h.transpose() * (h * p * h.transpose() + r).try_inverse().expect("R is positive");
        let expected = x + gain * (z - h * x);
        let expected_covariance = (Matrix2::identity() - gain * h) * p;
        prop_assert!((state - expected).norm() < 1e-9);
        prop_assert!((Matrix2::identity() * covariance - expected_covariance).norm() < 1e-9);
    }

    #[test]
    fn two_measurements_at_once_are_one_after_the_other(p in 0.01..16.0, imu in measurement(), bend in measurement()) {
        let gains = gains(0.0, (imu.0, imu.1), (bend.0, bend.1));
        let by = |steps: &[[bool; 2]]| {
            let mut filter = started(point(0.0, 1.0), p);
            for [with_imu, with_bend] in steps {
                filter.step(&gains, with_imu.then_some(imu.2), with_bend.then_some(bend.2));
            }
            filter.state().expect("it was measured")
        };
        let (x, p) = by(&[[true, true]]);
        for (other_x, other_p) in [by(&[[true, false], [false, true]]), by(&[[false, true], [true, false]])] {
            prop_assert!((x - other_x).norm() < 1e-10 && (p - other_p).abs() < 1e-10);
        }
    }

    #[test]
    fn coordinates_do_not_couple(p in 0.01..16.0, imu in measurement(), bend in measurement()) {
        let gains = gains(0.0, (imu.0, imu.1), (bend.0, bend.1));
        let mut both = started(point(0.5, -0.5), p);
        both.step(&gains, Some(imu.2), Some(bend.2));
        let (x, p_both) = both.state().expect("it was measured");
        for (axis, start) in [(0, 0.5), (1, -0.5)] {
            let mut one = KalmanFilter::<f64, 1>::new();
            one.step(&alone(0.0, 1.0, p), Some(SVector::from([start])), None);
            one.step(&gains, Some(SVector::from([imu.2[axis]])), Some(SVector::from([bend.2[axis]])));
            prop_assert_eq!(scalar(&one), (x[axis], p_both));
        }
    }

    #[test]
    fn the_first_measurement_starts_the_filter((h, r, z) in measurement()) {
        let mut filter = KalmanFilter::new();
        filter.step(&alone(1.0, h, r), None, Some(z));
        let (x, p) = filter.state().expect("it was measured");
        prop_assert!((x - z / h).norm() < 1e-12 && (p - r / (h * h)).abs() < 1e-12);
    }

    #[test]
    fn two_first_measurements_start_it_at_their_weighed_mean(imu in measurement(), bend in measurement()) {
        let ((h1, r1, z1), (h2, r2, z2)) = (imu, bend);
        let mut filter = KalmanFilter::new();
        filter.step(&gains(1.0, (h1, r1), (h2, r2)), Some(z1), Some(z2));
        let (x, p) = filter.state().expect("it was measured");
        let information = h1 * h1 / r1 + h2 * h2 / r2;
        prop_assert!((x - (z1 * (h1 / r1) + z2 * (h2 / r2)) / information).norm() < 1e-12);
        prop_assert!((p - 1.0 / information).abs() < 1e-12);
    }

    #[test]
    fn a_missing_measurement_leaves_the_state_and_grows_the_covariance(p in 0.01..8.0, q in 0.0..8.0) {
        let mut filter = started(point(0.5, -0.5), p);
        filter.step(&alone(q, 1.0, 1.0), None, None);
        let (x, grown) = filter.state().expect("it was measured");
        prop_assert_eq!((x, grown), (point(0.5, -0.5), p + q));
    }

    #[test]
    fn a_measurement_never_grows_the_covariance(p in 0.01..16.0, (h, r, z) in measurement()) {
        let mut filter = started(point(0.0, 0.0), p);
        filter.step(&alone(0.0, h, r), Some(z), None);
        let (_, after) = filter.state().expect("it was measured");
        prop_assert!(after < p && after > 0.0);
    }

    /// One step with H² P + R within Q's 32. Half a step of 2⁻²⁶ each in p, h and r is worth up to 2e-7 of the gain at
    /// p, r ≥ 0.1, and innovations are up to 8.
    #[test]
    fn a_fixed_point_update_is_the_floats(p in 0.1..10.0, h in 0.5..1.5, r in 0.1..5.0, x in -2.0..2.0, z in -2.0..2.0) {
        fn run<S: FusedOps>(x: f64, p: f64, z: f64, h: f64, r: f64) -> [f64; 2] {
            let mut filter = KalmanFilter::<S, 1>::new();
            filter.step(&alone(0.0, 1.0, p), Some(SVector::from([S::from_f64(x)])), None);
            filter.step(&alone(0.0, h, r), Some(SVector::from([S::from_f64(z)])), None);
            let (x, p) = filter.state().expect("it was measured");
            [x.x.to_f64(), p.to_f64()]
        }
        let [[x_float, p_float], [x_fixed, p_fixed]] = [run::<f64>(x, p, z, h, r), run::<Q>(x, p, z, h, r)];
        prop_assert!((x_fixed - x_float).abs() < 1e-6, "{} instead of {}", x_fixed, x_float);
        prop_assert!((p_fixed - p_float).abs() < 1e-6, "{} instead of {}", p_fixed, p_float);
    }
}

#[test]
fn a_filter_without_a_measurement_has_no_state() {
    let mut filter = KalmanFilter::<f64, 1>::new();
    filter.step(&alone(1.0, 1.0, 1.0), None, None);
    assert_eq!(filter.state(), None);
}

#[test]
fn time_before_the_first_measurement_does_not_count() {
    let mut filter = KalmanFilter::<f64, 1>::new();
    filter.step(&alone(5.0, 1.0, 0.5), None, None);
    filter.step(&alone(5.0, 1.0, 0.5), Some(SVector::from([0.25])), None);
    assert_eq!(scalar(&filter), (0.25, 0.5));
}

#[test]
fn the_covariance_grows_to_the_limit_and_no_further() {
    let mut filter = KalmanFilter::<f64, 1>::new();
    let step = COVARIANCE_LIMIT * 0.4;
    filter.step(&alone(step, 1.0, 1.0), Some(SVector::from([0.0])), None);
    let growth = [0; 5].map(|_| {
        filter.step(&alone(step, 1.0, 1.0), None, None);
        scalar(&filter).1
    });
    let expected = [1.0 + step, 1.0 + 2.0 * step, COVARIANCE_LIMIT, COVARIANCE_LIMIT, COVARIANCE_LIMIT];
    assert_eq!(growth.map(f64::to_bits), expected.map(f64::to_bits));
}

#[test]
fn fixed_point_covariance_reaches_the_limit_however_large_its_growth() {
    let mut filter = KalmanFilter::<Q, 1>::new();
    let gains = alone(Q::MAX.to_f64(), 1.0, 1.0);
    filter.step(&gains, Some(SVector::from([Q::from_f64(0.5)])), None);
    for _ in 0..3 {
        filter.step(&gains, None, None);
    }
    let (x, p) = filter.state().expect("it was measured");
    assert_eq!((x.x, p), (Q::from_f64(0.5), Q::from_f64(COVARIANCE_LIMIT)));
}

/// With P and H at their limits, H² P + R is 26 of the 32 that Q holds.
#[test]
fn after_an_outage_fixed_point_takes_a_measurement_as_floats_do() {
    let mut filter = KalmanFilter::<Q, 1>::new();
    filter.step(&alone(0.0, 1.0, 1.0), Some(SVector::from([Q::from_f64(0.0)])), None);
    filter.step(&alone(COVARIANCE_LIMIT, H_LIMIT, 1.0), Some(SVector::from([Q::from_f64(1.0)])), None);
    let (x, _) = filter.state().expect("it was measured");
    let gain = COVARIANCE_LIMIT * H_LIMIT / (COVARIANCE_LIMIT * H_LIMIT * H_LIMIT + 1.0);
    assert!((x.x.to_f64() - gain).abs() < 4.0 / 67_108_864.0, "{} instead of {gain}", x.x.to_f64());
}
