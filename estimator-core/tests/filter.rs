//! One filter block against the textbook's matrices.

use estimator_core::{Block, COVARIANCE_LIMIT, H_LIMIT, Q, Scalar};
use nalgebra::{Matrix2, Matrix4, Matrix4x2, SVector, Vector2, Vector4};
use proptest::prelude::*;

fn point(x: f64, y: f64) -> SVector<f64, 2> {
    SVector::from([x, y])
}

/// A filter that was started at a point with this covariance.
fn started(x: Vector2<f64>, p: f64) -> Block<f64, 2> {
    let mut block = Block::new();
    block.update(x, 1.0, p);
    block
}

fn scalar(block: &Block<f64, 1>) -> (f64, f64) {
    let (x, p) = block.state().expect("it was measured");
    (x.x, p)
}

prop_compose! {
    /// h, r and z of one measurement.
    fn measurement()(h in 0.5..2.0, r in 0.01..30.0, x in -2.0..2.0, y in -2.0..2.0) -> (f64, f64, Vector2<f64>) {
        (h, r, point(x, y))
    }
}

proptest! {
    /// KF_coord by the book: both measurements stacked, K = P⁻Hᵀ(H P⁻ Hᵀ + R)⁻¹. Only floats' rounding differs, grown by
    /// the square of the matrix's condition, up to 6000.
    #[test]
    fn two_updates_are_one_with_both_measurements_stacked(
        p in 0.01..8.0, q in 0.0..8.0, imu in measurement(), bend in measurement()
    ) {
        let x = point(0.3, -0.2);
        let mut block = started(x, p);
        block.predict(q);
        for (h, r, z) in [imu, bend] {
            block.update(z, h, r);
        }
        let (state, covariance) = block.state().expect("it was measured");

        let ((h1, r1, z1), (h2, r2, z2)) = (imu, bend);
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
    fn the_order_of_the_measurements_does_not_matter(p in 0.01..20.0, imu in measurement(), bend in measurement()) {
        let by = |order: [(f64, f64, Vector2<f64>); 2]| {
            let mut block = started(point(0.0, 1.0), p);
            for (h, r, z) in order {
                block.update(z, h, r);
            }
            block.state().expect("it was measured")
        };
        let ((x, p), (other_x, other_p)) = (by([imu, bend]), by([bend, imu]));
        prop_assert!((x - other_x).norm() < 1e-10 && (p - other_p).abs() < 1e-10);
    }

    #[test]
    fn coordinates_do_not_couple(p in 0.01..20.0, (h, r, z) in measurement()) {
        let mut both = started(point(0.5, -0.5), p);
        both.update(z, h, r);
        let (x, p_both) = both.state().expect("it was measured");
        for (axis, start) in [(0, 0.5), (1, -0.5)] {
            let mut one = Block::<f64, 1>::new();
            one.update(SVector::from([start]), 1.0, p);
            one.update(SVector::from([z[axis]]), h, r);
            prop_assert_eq!(scalar(&one), (x[axis], p_both));
        }
    }

    #[test]
    fn the_first_measurement_starts_the_filter((h, r, z) in measurement()) {
        let mut block = Block::new();
        block.update(z, h, r);
        let (x, p) = block.state().expect("it was measured");
        prop_assert!((x - z / h).norm() < 1e-12 && (p - r / (h * h)).abs() < 1e-12);
    }

    #[test]
    fn a_missing_measurement_leaves_the_state_and_grows_the_covariance(p in 0.01..8.0, q in 0.0..8.0) {
        let mut block = started(point(0.5, -0.5), p);
        block.predict(q);
        let (x, grown) = block.state().expect("it was measured");
        prop_assert_eq!((x, grown), (point(0.5, -0.5), p + q));
    }

    #[test]
    fn a_measurement_never_grows_the_covariance(p in 0.01..31.0, (h, r, z) in measurement()) {
        let mut block = started(point(0.0, 0.0), p);
        block.update(z, h, r);
        let (_, after) = block.state().expect("it was measured");
        prop_assert!(after < p && after > 0.0);
    }

    /// One step with H² P + R within Q's 32. Half a step of 2⁻²⁶ each in p, h and r is worth up to 2e-7 of the gain at
    /// p, r ≥ 0.1, and innovations are up to 8.
    #[test]
    fn a_fixed_point_update_is_the_floats(p in 0.1..10.0, h in 0.5..1.5, r in 0.1..5.0, x in -2.0..2.0, z in -2.0..2.0) {
        fn run<S: Scalar>(x: f64, p: f64, z: f64, h: f64, r: f64) -> [f64; 2] {
            let mut block = Block::<S, 1>::new();
            block.update(SVector::from([S::from_f64(x)]), S::one(), S::from_f64(p));
            block.update(SVector::from([S::from_f64(z)]), S::from_f64(h), S::from_f64(r));
            let (x, p) = block.state().expect("it was measured");
            [x.x.to_f64(), p.to_f64()]
        }
        let [[x_float, p_float], [x_fixed, p_fixed]] = [run::<f64>(x, p, z, h, r), run::<Q>(x, p, z, h, r)];
        prop_assert!((x_fixed - x_float).abs() < 1e-6, "{} instead of {}", x_fixed, x_float);
        prop_assert!((p_fixed - p_float).abs() < 1e-6, "{} instead of {}", p_fixed, p_float);
    }
}

#[test]
fn a_filter_without_a_measurement_has_no_state() {
    let mut block = Block::<f64, 1>::new();
    block.predict(1.0);
    assert_eq!(block.state(), None);
}

#[test]
fn time_before_the_first_measurement_does_not_count() {
    let mut block = Block::<f64, 1>::new();
    block.predict(5.0);
    block.update(SVector::from([0.25]), 1.0, 0.5);
    assert_eq!(scalar(&block), (0.25, 0.5));
}

#[test]
fn the_covariance_grows_to_the_limit_and_no_further() {
    let mut block = Block::<f64, 1>::new();
    block.update(SVector::from([0.0]), 1.0, 1.0);
    let step = COVARIANCE_LIMIT * 0.4;
    let growth = [0; 5].map(|_| {
        block.predict(step);
        scalar(&block).1
    });
    let expected = [1.0 + step, 1.0 + 2.0 * step, COVARIANCE_LIMIT, COVARIANCE_LIMIT, COVARIANCE_LIMIT];
    assert_eq!(growth.map(f64::to_bits), expected.map(f64::to_bits));
}

#[test]
fn fixed_point_covariance_reaches_the_limit_however_large_its_growth() {
    let mut block = Block::<Q, 1>::new();
    block.update(SVector::from([Q::from_f64(0.5)]), Q::from_f64(1.0), Q::from_f64(1.0));
    for _ in 0..3 {
        block.predict(Q::MAX);
    }
    let (x, p) = block.state().expect("it was measured");
    assert_eq!((x.x, p), (Q::from_f64(0.5), Q::from_f64(COVARIANCE_LIMIT)));
}

/// With P and H at their limits, H² P + R is 26 of the 32 that Q holds.
#[test]
fn after_an_outage_fixed_point_takes_a_measurement_as_floats_do() {
    let mut block = Block::<Q, 1>::new();
    block.update(SVector::from([Q::from_f64(0.0)]), Q::from_f64(1.0), Q::from_f64(1.0));
    block.predict(Q::from_f64(COVARIANCE_LIMIT));
    block.update(SVector::from([Q::from_f64(1.0)]), Q::from_f64(H_LIMIT), Q::from_f64(1.0));
    let (x, _) = block.state().expect("it was measured");
    let gain = COVARIANCE_LIMIT * H_LIMIT / (COVARIANCE_LIMIT * H_LIMIT * H_LIMIT + 1.0);
    assert!((x.x.to_f64() - gain).abs() < 4.0 / 67_108_864.0, "{} instead of {gain}", x.x.to_f64());
}
