//! The count of saturations, which is of the whole program and therefore has a test program of its own.

mod common;

use std::sync::{Mutex, PoisonError};

use estimator_core::{
    AnchorConfig, ArmConfig, BendMap, BendSensorConfig, Estimator, ImuReading, Phase, Q, QuadraticMap, Sample, Scalar,
    SegmentConfig, Turns, saturations,
};
use num_traits::Zero;

/// Tests run in threads; the count is common to them.
static TURN: Mutex<()> = Mutex::new(());

/// Number of saturations that `work` causes.
fn counted(work: impl FnOnce()) -> u32 {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let before = saturations();
    work();
    saturations() - before
}

fn ignore(_: Q) {}

#[test]
fn each_operation_that_does_not_fit_counts_once() {
    let large = Q::from_f64(20.0);
    assert_eq!(counted(|| ignore(large + large)), 1);
    assert_eq!(counted(|| ignore(-large - large)), 1);
    assert_eq!(counted(|| ignore(large * large)), 1);
    assert_eq!(counted(|| ignore(large / Q::from_f64(0.1))), 1);
    assert_eq!(counted(|| ignore(-Q::MIN)), 1);
    assert_eq!(counted(|| ignore(Q::from_int(32))), 1);
}

#[test]
fn a_division_by_zero_counts() {
    assert_eq!(counted(|| ignore(Q::from_f64(1.0) / Q::zero())), 1);
}

#[test]
fn operations_that_just_fit_do_not_count() {
    let edge = || {
        ignore(Q::MAX + Q::zero());
        ignore(Q::MIN + Q::MAX);
        ignore(Q::MIN - Q::MIN);
        ignore(Q::MIN / Q::from_f64(1.0));
        ignore(Q::MAX * Q::from_f64(1.0));
        ignore(-Q::MAX);
    };
    assert_eq!(counted(edge), 0);
}

#[test]
fn floats_from_tables_saturate_uncounted() {
    assert_eq!(counted(|| ignore(Q::from_f64(1e9))), 0);
}

/// Steps of an arm with one sensor of θ = 1.2 (V − 1.5) at these counts.
fn run(counts: u16, steps: u32) {
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.2, -1.8, [0.5, 2.5]));
    let sensor = BendSensorConfig { map, memory: None };
    let segments = [SegmentConfig { bend: [Some(sensor), None], ..SegmentConfig::<Q>::uncalibrated(0.08, 0.017) }; 3];
    let anchor = AnchorConfig {
        window: 10,
        rate_millihertz: 10_000,
        sample_rate_millihertz: 10_000,
        threshold: Turns::from_rad(0.01),
    };
    let table = ArmConfig { tare_samples: 10, anchor, ..ArmConfig::uncalibrated(&segments) };
    let mut estimator = Estimator::<Q, 3, 10>::new(&table).expect("a valid table");
    for step in 0..steps {
        let mut sample = Sample::missing(0);
        sample.bend = [[Some(counts), None]; 3];
        // 20 turns and more of drift.
        let heading = Phase::from_degrees(f64::from(step) * 7.0);
        sample.imu = [Some(ImuReading::Heading(heading)); 3];
        let estimate = estimator.update_full(&sample);
        for method in estimator_core::Method::ALL {
            let _ = estimator.shape(&estimate, method);
        }
    }
}

#[test]
fn a_session_with_turns_and_turns_of_drift_counts_nothing() {
    assert_eq!(counted(|| run(1900, 1100)), 0);
}

/// An hour of swings, rests and outages with the bias filter, and its estimates.
fn run_bias_filter() {
    let segments = common::segments::<Q>();
    let config = common::config(&segments, 10.0);
    let mut estimator = Estimator::<Q, { common::N }, 100>::new(&config).expect("a valid configuration");
    let mut arm = common::Arm { drift: [0.05, -0.03, 0.02], bend_offset: [2.0, -3.0, 1.0], ..Default::default() };
    for k in 0..36_000 {
        let mut sample = arm.sample(k);
        match k {
            4_000..7_000 => sample.imu[0] = None,
            8_000..11_000 => sample.bend = [[None; 2]; common::N],
            // A rest of five minutes, at the last angles.
            12_000..15_000 => sample = Sample { time_us: sample.time_us, ..arm.sample(12_000) },
            16_000..19_000 => continue,
            20_000..36_000 => sample.bend[1] = [None; 2],
            _ => {}
        }
        estimator.update(&sample);
        let _ = (estimator.uncertainties(), estimator.contacts());
    }
}

#[test]
fn an_hour_of_the_bias_filter_counts_nothing() {
    assert_eq!(counted(run_bias_filter), 0);
}

#[test]
fn a_table_out_of_range_is_noticed() {
    let segment =
        SegmentConfig { length: Q::from_f64(30.0), offset: Q::from_f64(30.0), ..SegmentConfig::uncalibrated(1.0, 1.0) };
    let straight = || {
        let _ = estimator_core::Pcc::new(&segment).link(estimator_core::Angle::from(Q::zero()));
    };
    assert_eq!(counted(straight), 1);
}
