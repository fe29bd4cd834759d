//! Faults of the simulated sensors.

use std::path::Path;

use rig_twin::{Fault, FaultError, Layout, MotionProgram, Rig, Scenario, Setup, TimedFault, reference_table};

/// Readings of a sample: counts of the bend sensors, quaternions of the IMUs.
type Readings = (Vec<Option<u16>>, Vec<Option<[i16; 4]>>);

fn timed(text: &str) -> TimedFault {
    text.parse().expect("a valid fault")
}

/// Readings every 10 ms, of a rig with these faults.
fn readings(faults: &[&str], seconds: f64) -> Vec<Readings> {
    let (mut rig, program) = (Rig::new(Scenario::FreeSwing, 1), MotionProgram::new(Scenario::FreeSwing, 1));
    for fault in faults {
        rig.inject(timed(fault)).expect("the arm has the sensor");
    }
    let mut readings = Vec::new();
    while rig.time_s() < seconds {
        rig.step(0.01, &program.duties(rig.time_s()));
        readings.push((rig.adc_counts().to_vec(), rig.imu_quaternions().to_vec()));
    }
    readings
}

/// Heading, clockwise positive, degrees.
fn heading_deg(quaternion: [i16; 4]) -> f64 {
    let [w, x, y, z] = quaternion.map(|step| f64::from(step) / 16384.0);
    -(2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)).to_degrees()
}

/// Difference of two headings, from −180° to 180°.
fn turn_deg(from: [i16; 4], to: [i16; 4]) -> f64 {
    (heading_deg(to) - heading_deg(from) + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn faults_of_one_sensor_change_no_other_reading_and_none_before_their_begin() {
    let (good, faulty) = (readings(&[], 9.0), readings(&["bend2a:open@8", "imu3:frozen@8"], 9.0));
    assert_eq!(good[..799], faulty[..799]);
    for ((counts, quaternions), (faulty_counts, faulty_quaternions)) in good.iter().zip(&faulty).skip(799) {
        assert_eq!(faulty_counts[2], Some(4095));
        for index in (0..12).filter(|index| *index != 2) {
            assert_eq!(counts[index], faulty_counts[index], "bend sensor {index}");
        }
        for index in (0..6).filter(|index| *index != 2) {
            assert_eq!(quaternions[index], faulty_quaternions[index], "IMU {index}");
        }
        assert_eq!(faulty_quaternions[2], faulty[799].1[2]);
    }
}

#[test]
fn a_fault_with_a_duration_leaves_no_trace() {
    let faults = [
        "bend1a:short@1+0.5",
        "bend1b:drift=100@1+0.5",
        "imu1:jump=30@1+0.05",
        "imu2:frozen@1+0.5",
        "imu3:zeros@1+0.5",
    ];
    let (good, faulty) = (readings(&[], 3.0), readings(&faults, 3.0));
    assert_ne!(good[99], faulty[99]);
    assert_eq!(good[150..], faulty[150..]);
}

#[test]
fn bend_sensors_fail_as_their_faults_are_named() {
    let faults = [
        "bend1a:short@1",
        "bend1b:stuck@1",
        "bend2a:drift=100@1",
        "bend2b:offset=-300@1",
        "bend3a:factor=1.3@1",
        "bend3b:intermittent@1",
    ];
    let (good, faulty) = (readings(&[], 3.0), readings(&faults, 3.0));
    let counts =
        |readings: &[Readings], row: usize, sensor: usize| i32::from(readings[row].0[sensor].expect("it is there"));
    assert_eq!(counts(&faulty, 299, 0), 0);
    assert_eq!(counts(&faulty, 299, 1), counts(&good, 99, 1));
    assert_eq!(counts(&faulty, 299, 2), counts(&good, 299, 2) + 200);
    assert_eq!(counts(&faulty, 299, 3), counts(&good, 299, 3) - 300);
    assert_eq!(counts(&faulty, 299, 4), (f64::from(counts(&good, 299, 4)) * 1.3).round() as i32);
    let lost = (99..299).filter(|row| counts(&faulty, *row, 5) == 4095).count();
    assert_eq!(lost, 100, "every second conversion of two seconds");
}

#[test]
fn an_imu_that_restarts_is_silent_for_its_boot_and_returns_with_another_zero() {
    for (fault, silent, back) in
        [("imu3:reset@8", 799, 869), ("imu3:unplugged@7+1", 699, 844), ("imu3:brown-out@8", 799, 804)]
    {
        let (good, faulty) = (readings(&[], 9.0), readings(&[fault], 9.0));
        let imu = |readings: &[Readings], row: usize| readings[row].1[2];
        let lost: Vec<usize> = (0..900).filter(|row| imu(&faulty, *row).is_none()).collect();
        assert_eq!(lost, (silent..back).collect::<Vec<_>>(), "{fault}");
        let back = imu(&faulty, back).expect("it is back");
        assert!(heading_deg(back).abs() < 0.1, "{fault}: {}°", heading_deg(back));
        let [good, faulty] = [&good, &faulty].map(|readings| imu(readings, 899).expect("it is there"));
        assert!(turn_deg(good, faulty).abs() > 20.0, "{fault}: the zero of seed 1 is far from the heading's");
    }
}

#[test]
fn a_heading_that_jumps_is_turned_clockwise() {
    let (good, faulty) = (readings(&[], 2.0), readings(&["imu4:jump=30@1"], 2.0));
    let [good, faulty] = [good, faulty].map(|readings| readings[150].1[3].expect("it is there"));
    assert!((turn_deg(good, faulty) - 30.0).abs() < 0.02);
}

#[test]
fn quaternions_of_zeros_or_of_another_norm_are_as_named() {
    let faulty = readings(&["imu1:zeros@1", "imu2:norm=0.5@1", "imu3:norm=4@1", "imu4:random@1"], 2.0);
    let norm = |imu: usize| {
        let parts = faulty[150].1[imu].expect("it is there").map(|part| f64::from(part) / 16384.0);
        parts.iter().map(|part| part * part).sum::<f64>().sqrt()
    };
    assert!(norm(0) == 0.0 && (norm(1) - 0.5).abs() < 1e-3 && (norm(3) - 1.0).abs() < 1e-3);
    assert!(faulty[150].1[2].expect("it is there").contains(&i16::MAX) || norm(2) > 1.9, "registers saturate");
    assert_ne!(faulty[150].1[3], faulty[151].1[3], "each output is another");
}

#[test]
fn a_fault_is_cleared_before_its_end() {
    let mut rig = Rig::new(Scenario::FreeSwing, 1);
    let fault: Fault = "bend1a:open".parse().expect("a fault");
    rig.inject(TimedFault::from(fault, 0.0)).expect("the arm has the sensor");
    assert_eq!(rig.convert(0), Some(4095));
    rig.clear(fault);
    assert_ne!(rig.convert(0), Some(4095));
}

#[test]
fn sensors_that_the_arm_does_not_have_and_faults_of_the_board_are_refused() {
    let layout = Layout::uniform(3).expect("three segments");
    let mut rig = Rig::of(&Setup { layout, ..Setup::new(Scenario::FreeSwing, 1) });
    for fault in ["imu4:reset@1", "bend4a:open@1"] {
        let name = fault.split('@').next().unwrap_or_default().to_owned();
        assert_eq!(rig.inject(timed(fault)), Err(FaultError::NotOnArm(name)));
    }
    for fault in ["sda:held@1", "imu3:nack=0.1@1", "line:cut@1", "power:cut@1"] {
        assert!(matches!(rig.inject(timed(fault)), Err(FaultError::NotInSession(_))), "{fault}");
    }
}

#[test]
fn the_reference_lists_every_fault() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/faults.md");
    let page = std::fs::read_to_string(page).expect("the page is committed");
    let table = reference_table();
    assert!(page.contains(&table), "docs/reference/faults.md does not have this table:\n{table}");
}
