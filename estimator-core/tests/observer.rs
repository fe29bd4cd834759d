//! The drift observer against the same Kalman filter in floats, and against what happens on arms.

use estimator_core::{BiasFilterConfig, Disagreement, Observer, Turns};
use nalgebra::{Matrix3, RowVector3, Vector3};

/// Values a second.
const HZ: f64 = 10.0;
/// R, degrees².
const R: f64 = 500.0;
const UNIT: f64 = 1_073_741_824.0;
/// Standard deviations at the start: bias, degrees; rate, degrees in 64 s; slope, degrees in a quarter turn.
const PRIOR: [f64; 3] = [0.3, 3.2, 14.0];

fn degrees(degrees: f64) -> Turns {
    Turns::from_rad(degrees.to_radians())
}

fn rule() -> BiasFilterConfig {
    BiasFilterConfig {
        step: (4_294_967_296.0 / (HZ * BiasFilterConfig::RATE_S)).round() as u32,
        prior: PRIOR.map(|sigma| (sigma * sigma / R * UNIT) as i32),
        growth: [0, 35, 5],
        gate: degrees(8.0),
        patience: 300,
        jump: degrees(12.0),
        still: degrees(1.0),
        doubt: (6.25 / R * UNIT) as i32,
    }
}

/// The same filter, as the books have it, in degrees.
struct Book {
    x: Vector3<f64>,
    p: Matrix3<f64>,
}

impl Book {
    fn new() -> Self {
        Self { x: Vector3::zeros(), p: Matrix3::from_diagonal(&Vector3::from(PRIOR.map(|sigma| sigma * sigma))) }
    }

    fn step(&mut self, imu: f64, bend: f64) {
        let a = Matrix3::new(1.0, 1.0 / (HZ * BiasFilterConfig::RATE_S), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let growth = Vector3::from(rule().growth.map(|growth| f64::from(growth) / UNIT * R));
        let h = RowVector3::new(1.0, 0.0, bend / 90.0);
        self.x = a * self.x;
        self.p = a * self.p * a.transpose() + Matrix3::from_diagonal(&growth);
        let s = (h * self.p * h.transpose()).x + R;
        let k = self.p * h.transpose() / s;
        self.x += k * (imu - bend - (h * self.x).x);
        self.p -= k * h * self.p;
    }
}

/// A swing of ±40° and what lags behind it like hysteresis.
fn swing(k: u32) -> (f64, f64) {
    let phase = f64::from(k) / HZ / 8.0 * core::f64::consts::TAU;
    (40.0 * phase.sin(), 4.0 * phase.cos())
}

/// An hour of swings, with what an IMU says beyond the bend at each value.
fn hour(observer: &mut Observer, mut beyond: impl FnMut(u32, f64) -> f64) {
    for k in 0..36_000 {
        let (bend, lag) = swing(k);
        let imu = bend + lag + beyond(k, bend);
        observer.step(&rule(), Some(Disagreement { imu: degrees(imu), bend: degrees(bend) }));
    }
}

/// A zigzag of ±40° that moves by 2° from value to value, so that every one is news.
fn zigzag(k: u32) -> f64 {
    2.0 * f64::from(k % 80).min(80.0 - f64::from(k % 80)) - 40.0
}

#[test]
fn it_is_the_filter_of_the_books() {
    let (mut observer, mut book) = (Observer::new(&rule()), Book::new());
    for k in 0..36_000 {
        let bend = zigzag(k);
        let imu = 1.05 * bend + 0.005 * f64::from(k) + f64::from(k % 7) - 3.0;
        observer.step(&rule(), Some(Disagreement { imu: degrees(imu), bend: degrees(bend) }));
        book.step(imu, bend);
        let (bias, variance) = (observer.bias().rad().to_degrees(), f64::from(observer.variance()) / UNIT * R);
        assert!((bias - book.x.x).abs() < 0.02, "value {k}: {bias} instead of {}", book.x.x);
        assert!((variance / book.p.m11 - 1.0).abs() < 0.02, "value {k}: {variance} instead of {}", book.p.m11);
    }
}

#[test]
fn it_follows_a_drift_without_lag() {
    let mut observer = Observer::new(&rule());
    hour(&mut observer, |k, _| 0.005 * f64::from(k));
    assert!((observer.bias().rad().to_degrees() - 0.005 * 35_999.0).abs() < 0.1);
}

#[test]
fn it_follows_a_drift_whose_rate_changes() {
    let mut observer = Observer::new(&rule());
    hour(&mut observer, |k, _| if k < 18_000 { 0.005 * f64::from(k) } else { 90.0 - 0.002 * f64::from(k - 18_000) });
    assert!((observer.bias().rad().to_degrees() - (90.0 - 0.002 * 17_999.0)).abs() < 0.5);
}

#[test]
fn a_wrong_sensitivity_does_not_pull_the_bias_of_an_arm_that_leans() {
    let mut observer = Observer::new(&rule());
    for k in 0..36_000 {
        let (swing, lag) = swing(k);
        let bend = 20.0 + swing;
        let imu = 1.1 * bend + lag;
        observer.step(&rule(), Some(Disagreement { imu: degrees(imu), bend: degrees(bend) }));
    }
    assert!(observer.bias().rad().to_degrees().abs() < 0.3, "{}", observer.bias().rad().to_degrees());
}

#[test]
fn a_push_is_left_out() {
    let (mut pushed, mut free) = (Observer::new(&rule()), Observer::new(&rule()));
    // Every minute for three seconds, with half a second to come and to go.
    let push = |k: u32| 14.0 * f64::from((k % 600).saturating_sub(570).min(600 - k % 600).min(5)) / 5.0;
    hour(&mut pushed, |k, _| 0.001 * f64::from(k) - push(k));
    hour(&mut free, |k, _| 0.001 * f64::from(k));
    assert!(
        (pushed.bias() - free.bias()).rad().to_degrees().abs() < 0.3,
        "{}",
        (pushed.bias() - free.bias()).rad().to_degrees()
    );
}

#[test]
fn a_jump_of_the_imu_is_taken_over_at_once() {
    let mut observer = Observer::new(&rule());
    hour(&mut observer, |k, _| if k < 20_000 { 0.0 } else { 30.0 });
    assert!((observer.bias().rad().to_degrees() - 30.0).abs() < 1.0);
}

#[test]
fn a_bend_sensor_that_sticks_does_not_drag_the_bias() {
    let mut observer = Observer::new(&rule());
    for k in 0..36_000 {
        let (bend, _) = swing(k);
        let stuck = if k < 18_000 { bend } else { 35.0 };
        observer.step(&rule(), Some(Disagreement { imu: degrees(bend), bend: degrees(stuck) }));
    }
    assert!(observer.bias().rad().to_degrees().abs() < 3.0, "{}", observer.bias().rad().to_degrees());
}

/// How far the bias is off, degrees, when an arm has rested for a time where its bend sensors are off by 5°.
fn off_after_rest(values: u32) -> f64 {
    let mut observer = Observer::new(&rule());
    hour(&mut observer, |k, _| 0.001 * f64::from(k));
    let imu = |k: u32| 30.0 + 36.0 + 0.001 * f64::from(k);
    for k in 0..values {
        observer.step(&rule(), Some(Disagreement { imu: degrees(imu(k)), bend: degrees(35.0) }));
    }
    observer.bias().rad().to_degrees() - (36.0 + 0.001 * f64::from(values))
}

#[test]
fn an_arm_at_rest_teaches_its_bend_sensors_error_to_nobody() {
    assert!(off_after_rest(3_000).abs() < 0.3, "{}", off_after_rest(3_000));
}

#[test]
fn an_arm_that_rests_for_hours_is_off_by_its_bend_sensors_error_at_worst() {
    assert!(off_after_rest(100_000).abs() < 5.3, "{}", off_after_rest(100_000));
}

#[test]
fn missing_values_cost_no_drift_that_was_known() {
    let mut observer = Observer::new(&rule());
    hour(&mut observer, |k, _| 0.005 * f64::from(k));
    for _ in 0..3_000 {
        observer.step(&rule(), None);
    }
    assert!((observer.bias().rad().to_degrees() - 0.005 * 39_000.0).abs() < 0.5);
}

#[test]
fn a_day_of_any_bend_leaves_its_variances_positive() {
    let mut observer = Observer::new(&rule());
    let mut state = 1_u64;
    for _ in 0..864_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bend = Turns::from_bits(i64::from((state >> 32) as i32));
        let noise = Turns::from_bits(((state >> 40) as i64 & 0xFF_FFFF) - 0x80_0000);
        observer.step(&rule(), (state & 7 != 0).then_some(Disagreement { imu: bend + noise, bend }));
        assert!(observer.variance() > 0);
    }
    assert!(observer.bias().rad().abs() < 1e-3);
}
