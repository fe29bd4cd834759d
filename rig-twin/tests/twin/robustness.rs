//! No input causes a panic of the twin or an invalid reading.

use rig_twin::{MotionProgram, Rig, SEGMENTS, Scenario};

#[test]
fn duties_out_of_range_count_as_the_nearest_and_no_number_as_zero() {
    let [odd, plain] =
        [[f64::NAN, -3.0, f64::INFINITY, f64::NEG_INFINITY, 2.0, f64::NAN], [0.0, 0.0, 1.0, 0.0, 1.0, 0.0]].map(
            |duties| {
                let mut rig = Rig::new(Scenario::Push, 1);
                rig.step(8.0, &duties);
                (rig.truth(), rig.adc_counts(), rig.imu_quaternions())
            },
        );
    assert_eq!(odd, plain);
}

#[test]
fn steps_that_are_not_positive_do_nothing() {
    let mut rig = Rig::new(Scenario::FreeSwing, 1);
    for dt_s in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        rig.step(dt_s, &[1.0; 6]);
    }
    assert!(rig.time_s().abs() < f64::EPSILON);
}

#[test]
fn endless_step_is_cut_to_an_hour() {
    let mut rig = Rig::new(Scenario::Obstacle, 1);
    rig.step(f64::INFINITY, &[1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    assert!((rig.time_s() - 3600.0).abs() < 1e-6, "{} s", rig.time_s());
    assert!(rig.truth()[SEGMENTS - 1].x_m.is_finite());
}

#[test]
fn programs_answer_any_time_with_duties() {
    for t_s in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e12, f64::MAX] {
        let duties = MotionProgram::new(Scenario::Obstacle, u64::MAX).duties(t_s);
        assert!(duties.iter().all(|duty| (0.0..=1.0).contains(duty)), "{duties:?} at {t_s}");
    }
}
