//! Arms of 1 to 8 segments, with other lengths and other sensors.

use rig_twin::{EndPose, Layout, LayoutError, MAX_SEGMENTS, MotionProgram, Rig, Scenario, SegmentLayout, Setup};

/// A session of seed 3 on an arm of the reference arm's tolerances.
fn setup(layout: &Layout, scenario: Scenario) -> Setup {
    Setup { layout: layout.clone(), ..Setup::new(scenario, 3) }
}

fn uniform(segments: usize) -> Layout {
    Layout::uniform(segments).expect("1 to 8 segments")
}

/// Segments with a curve of 120 mm and a connector of 30 mm that follows it, alternately of 60 mm and 5 mm.
fn unequal(segments: usize) -> Layout {
    let segment = |index: usize| {
        let (curve_m, connector_m) = if index.is_multiple_of(2) { (0.120, 0.030) } else { (0.060, 0.005) };
        SegmentLayout { curve_m, connector_m, connector_first: false, bend: [true; 2], imu: true }
    };
    Layout::new(&(0..segments).map(segment).collect::<Vec<_>>()).expect("valid lengths")
}

/// Change of the heading over each segment, rad.
fn bends_rad(truth: &[EndPose]) -> Vec<f64> {
    let before = [0.0].into_iter().chain(truth.iter().map(|pose| pose.heading_rad));
    truth.iter().zip(before).map(|(pose, before_rad)| pose.heading_rad - before_rad).collect()
}

/// End of a chain of circular arcs, each with its connector behind it, m.
fn tip_of_arcs(layout: &Layout, bends_rad: &[f64]) -> (f64, f64) {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for (segment, bend) in layout.segments().iter().zip(bends_rad) {
        let chord_m = 2.0 * segment.curve_m / bend * (bend / 2.0).sin();
        x += chord_m * (heading + bend / 2.0).sin() + segment.connector_m * (heading + bend).sin();
        y += chord_m * (heading + bend / 2.0).cos() + segment.connector_m * (heading + bend).cos();
        heading += bend;
    }
    (x, y)
}

#[test]
fn straight_arms_are_as_long_as_their_segments() {
    for (layout, length_m) in [(uniform(1), 0.097), (uniform(3), 0.291), (uniform(8), 0.776), (unequal(3), 0.365)] {
        let truth = Rig::of(&setup(&layout, Scenario::FreeSwing)).truth();
        let tip = truth[truth.len() - 1];
        assert_eq!(truth.len(), layout.segments().len());
        assert!((tip.y_m - length_m).abs() < 1e-12 && tip.x_m.abs() < 1e-12, "{tip:?} instead of {length_m} m");
    }
}

/// Constant curvature is an approximation: 2 to 5 mm on the reference arm, one percent of its length.
#[test]
fn bent_arms_end_near_a_chain_of_arcs_of_their_lengths() {
    for segments in [1, 3, 8] {
        let layout = unequal(segments);
        let mut rig = Rig::of(&setup(&layout, Scenario::FreeSwing));
        rig.step(10.0, &[0.3, 0.0, 0.0, 0.2, 0.4, 0.0, 0.5, 0.0]);
        let truth = rig.truth();
        let tip = truth[segments - 1];
        let (x_m, y_m) = tip_of_arcs(&layout, &bends_rad(&truth));
        let miss_m = (tip.x_m - x_m).hypot(tip.y_m - y_m);
        let length_m: f64 = layout.segments().iter().map(|segment| segment.curve_m + segment.connector_m).sum();
        assert!(tip.heading_rad.abs() > 0.1 && miss_m < 0.015 * length_m, "{segments} segments: {miss_m} m");
    }
}

#[test]
fn each_module_bends_under_its_own_two_regulators() {
    for segments in 1..=MAX_SEGMENTS {
        let layout = uniform(segments);
        for regulator in 0..layout.regulators() {
            let mut rig = Rig::of(&setup(&layout, Scenario::FreeSwing));
            let mut duties = [0.0; 8];
            duties[regulator] = 0.5;
            rig.step(5.0, &duties);
            for (segment, bend) in bends_rad(&rig.truth()).into_iter().enumerate() {
                let direction = if regulator.is_multiple_of(2) { 1.0 } else { -1.0 };
                let is_its_own = segment / 2 == regulator / 2;
                assert_eq!(direction * bend > 0.2, is_its_own, "segment {segment}, regulator {regulator}: {bend} rad");
                assert!(is_its_own || bend.abs() < 1e-12, "segment {segment}, regulator {regulator}: {bend} rad");
            }
        }
    }
}

#[test]
fn last_segment_of_an_odd_number_is_a_module_of_its_own() {
    let modules = [1, 1, 2, 2, 3, 3, 4, 4];
    for (segments, modules) in (1..).zip(modules) {
        let layout = uniform(segments);
        assert_eq!((layout.modules(), layout.regulators()), (modules, 2 * modules), "{segments} segments");
        let program = MotionProgram::of(&setup(&layout, Scenario::FreeSwing));
        assert_eq!(program.duties(20.0).len(), 2 * modules, "{segments} segments");
    }
}

#[test]
fn missing_duties_vent_and_further_ones_have_no_effect() {
    let truth = |duties: &[f64]| {
        let mut rig = Rig::of(&setup(&uniform(3), Scenario::FreeSwing));
        rig.step(5.0, duties);
        rig.truth()
    };
    assert_eq!(truth(&[0.5]), truth(&[0.5, 0.0, 0.0, 0.0]));
    assert_eq!(truth(&[0.5, 0.0, 0.0, 0.3]), truth(&[0.5, 0.0, 0.0, 0.3, 1.0, 1.0]));
}

/// A run of ten seconds of a sweep: true poses and quaternions at its end, and duties.
fn end_of_sweep(arm_seed: u64, layout: &Layout) -> (Vec<EndPose>, Vec<Option<[i16; 4]>>, Vec<f64>) {
    let setup = Setup { arm_seed, ..setup(layout, Scenario::Sweep) };
    let (program, mut rig) = (MotionProgram::of(&setup), Rig::of(&setup));
    for _ in 0..1000 {
        rig.step(0.01, &program.duties(rig.time_s()));
    }
    (rig.truth().to_vec(), rig.imu_quaternions().to_vec(), program.duties(10.0).to_vec())
}

#[test]
fn first_six_segments_of_a_longer_arm_are_those_of_the_arm_of_six() {
    for arm_seed in [0, 1, 9] {
        let (six, eight) = (end_of_sweep(arm_seed, &Layout::default()), end_of_sweep(arm_seed, &uniform(8)));
        assert_eq!((&six.0[..], &six.1[..], &six.2[..]), (&eight.0[..6], &eight.1[..6], &eight.2[..6]));
        assert!(eight.0[7] != eight.0[5] && eight.1[6] != eight.1[7]);
    }
}

#[test]
fn absent_sensors_give_nothing_and_change_nothing_else() {
    let all = uniform(3);
    let mut segments = all.segments().to_vec();
    segments[0].bend = [false, true];
    segments[1].bend = [false; 2];
    segments[2].imu = false;
    let some = Layout::new(&segments).expect("sensors are a choice");
    let counts = Rig::of(&setup(&some, Scenario::FreeSwing)).adc_counts();
    assert_eq!(counts.iter().map(Option::is_some).collect::<Vec<_>>(), [false, true, false, false, true, true]);
    let ((all_truth, all_imus, _), (truth, imus, _)) = (end_of_sweep(0, &all), end_of_sweep(0, &some));
    assert_eq!((&all_truth, &all_imus[..2], None), (&truth, &imus[..2], imus[2]));
}

#[test]
fn a_sensor_that_does_not_exist_has_no_conversion() {
    let mut rig = Rig::of(&setup(&uniform(2), Scenario::FreeSwing));
    assert!(rig.convert(3).is_some());
    assert_eq!(rig.convert(4), None);
}

/// Largest bend in rad that contacts add to each segment within 200 s.
fn largest_touches_rad(segments: usize, scenario: Scenario) -> Vec<f64> {
    let setup = setup(&uniform(segments), scenario);
    let (program, mut rig) = (MotionProgram::of(&setup), Rig::of(&setup));
    let mut largest = vec![0.0_f64; segments];
    for _ in 0..2000 {
        rig.step(0.1, &program.duties(rig.time_s()));
        largest.iter_mut().zip(rig.contact_bends_rad()).for_each(|(largest, bend)| *largest = largest.max(bend.abs()));
    }
    largest
}

/// It turns back the half below it, wraps itself by 70 % of that, and the next one by 25 %.
#[test]
fn obstacle_is_met_by_the_segment_after_half_of_them() {
    for segments in 2..=MAX_SEGMENTS {
        let touches = largest_touches_rad(segments, Scenario::Obstacle);
        let (below, above) = touches.split_at(segments / 2);
        let back_rad: f64 = below.iter().sum();
        assert!(back_rad > 0.1, "{segments} segments: {touches:?}");
        for (touch, share) in above.iter().zip([0.7, 0.25, 0.0, 0.0]) {
            assert!((touch - share * back_rad).abs() < 1e-9, "{segments} segments: {touches:?}");
        }
    }
    assert!(largest_touches_rad(1, Scenario::Obstacle)[0] < f64::EPSILON, "nothing below it turns back");
}

#[test]
fn sticks_push_every_segment() {
    for segments in [1, 3, 8] {
        let touches = largest_touches_rad(segments, Scenario::Push);
        assert!(touches.iter().all(|&bend| bend > 0.04), "{segments} segments: {touches:?}");
    }
}

#[test]
fn long_arms_do_not_coil_up_in_scenario_one() {
    let setup = setup(&uniform(8), Scenario::FreeSwing);
    let (program, mut rig) = (MotionProgram::of(&setup), Rig::of(&setup));
    for _ in 0..3000 {
        rig.step(0.1, &program.duties(rig.time_s()));
        let heading_deg = rig.truth()[7].heading_rad.to_degrees();
        assert!(heading_deg.abs() < 220.0, "{heading_deg}°");
    }
}

#[test]
fn layouts_that_cannot_be_are_refused() {
    assert_eq!(Layout::new(&[]), Err(LayoutError::Segments(0)));
    assert_eq!(Layout::uniform(9), Err(LayoutError::Segments(9)));
    let segment = uniform(1).segments()[0];
    for (curve_m, connector_m) in [(0.0, 0.017), (-0.08, 0.017), (0.08, -0.001), (f64::INFINITY, 0.0)] {
        let refused = Layout::new(&[segment, SegmentLayout { curve_m, connector_m, ..segment }]);
        assert_eq!(refused, Err(LayoutError::Length { segment: 1, curve_m, connector_m }));
    }
    assert!(Layout::new(&[SegmentLayout { curve_m: f64::NAN, ..segment }]).is_err());
}
