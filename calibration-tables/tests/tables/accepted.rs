//! Accepted files, and the defaults of omitted keys.

use std::path::Path;

use calibration_tables::{ArmFile, ChangeToml, CoupledToml, FileError, Side};
use estimator_core::{CoupledSegment, Coupling, Q, Response};

use super::common::{DESCRIPTION, TABLE, edited, parse};

#[test]
fn an_arm_description_is_read_with_its_defaults() {
    let arm = parse(DESCRIPTION);
    assert_eq!((arm.format, arm.arm.as_str()), (1, "finger"));
    assert!((arm.tare.seconds - 1.0).abs() < f64::EPSILON && arm.tare.heading_deg.is_empty());
    assert_eq!(arm.anchor.window, 100);
    assert!((arm.anchor.threshold_deg - 0.5).abs() < f64::EPSILON);
    assert!((arm.anchor.rate_hz - 10.0).abs() < f64::EPSILON);
    let [segment] = &arm.segments[..] else { panic!("one segment") };
    assert_eq!((&segment.bend, &segment.orient, &segment.coord), (&None, &None, &None));
    assert_eq!(segment.offset_at, Side::End);
}

#[test]
fn every_key_of_the_format_is_read() {
    let table = parse(TABLE);
    assert_eq!(table.tare.heading_deg, [5.0, -5.0]);
    let noise = table.segments[0].orient.as_ref().expect("it is in the file");
    let found = [noise.q, noise.r_imu, noise.r_bend, noise.h_imu, noise.h_bend];
    assert_eq!(found.map(f64::to_bits), [0.16, 0.0002, 0.002, 1.0, 1.0].map(f64::to_bits));
    let map = &table.segments[0].bend.as_ref().expect("it is in the file")[0];
    assert_eq!([map.c0, map.c1, map.c2].map(f64::to_bits), [-1.5, 0.8, 0.1].map(f64::to_bits));
    assert_eq!((map.rmse_deg, map.volts), (Some(4.7), Some([0.4, 2.6])));
    assert_eq!(table.segments[1].offset_at, Side::Start);
    assert_eq!(table.bend_sensors().expect("it is a table"), [1, 0]);
}

/// TOML has whole numbers apart from floats; people write 80 for 80.0.
#[test]
fn whole_numbers_without_a_decimal_point_are_read() {
    let whole = TABLE.replace(".0\n", "\n").replace(".0,", ",").replace(".0]", "]").replace(".0 }", " }");
    assert!(whole.contains("length_mm = 80\n") && whole.contains("h_imu = 1, h_bend = 1 }"));
    assert_eq!(parse(&whole), parse(TABLE));
}

#[test]
fn the_sections_of_the_format_may_be_partial() {
    let arm = parse(&format!("{DESCRIPTION}[tare]\nseconds = 0.0\n[anchor]\nwindow = 50\n"));
    assert_eq!((arm.tare.seconds.to_bits(), arm.anchor.window), (0.0_f64.to_bits(), 50));
    assert!((arm.anchor.threshold_deg - 0.5).abs() < f64::EPSILON);
}

#[test]
fn h_may_be_left_out_of_a_filters_parameters() {
    let table = parse(&edited(", h_imu = 1.0, h_bend = 1.0 }\ncoord", " }\ncoord"));
    assert_eq!(table, parse(TABLE));
}

#[test]
fn a_byte_order_mark_is_accepted() {
    assert_eq!(parse(&format!("\u{feff}{TABLE}")), parse(TABLE));
}

#[test]
fn line_ends_of_windows_are_accepted() {
    assert_eq!(parse(&TABLE.replace('\n', "\r\n")), parse(TABLE));
}

#[test]
fn one_and_sixteen_segments_are_accepted() {
    let (head, segment) = DESCRIPTION.split_once("[[segment]]").expect("it has a segment");
    for n in [1, 16] {
        assert_eq!(parse(&format!("{head}{}", format!("[[segment]]{segment}").repeat(n))).segments.len(), n);
    }
}

#[test]
fn the_limits_of_the_window_are_accepted() {
    for window in [1, 1000] {
        assert_eq!(parse(&edited("window = 100", &format!("window = {window}"))).anchor.window, window);
    }
}

#[test]
fn a_map_that_only_falls_is_accepted() {
    parse(&edited("c0 = -1.5, c1 = 0.8, c2 = 0.1", "c0 = 1.5, c1 = -0.8, c2 = -0.1"));
}

#[test]
fn a_map_that_turns_back_outside_its_voltages_is_accepted() {
    parse(&edited("c0 = -1.5, c1 = 0.8, c2 = 0.1", "c0 = 0.0, c1 = 1.0, c2 = -0.19"));
}

#[test]
fn a_straight_map_is_accepted() {
    parse(&edited("c2 = 0.1", "c2 = 0.0"));
}

#[test]
fn the_straight_arms_length_is_the_sum_of_its_parts() {
    assert!((parse(TABLE).length_mm() - 157.0).abs() < 1e-12);
    assert!((parse(calibration_tables::PLANAR_6_ARM).length_mm() - 582.0).abs() < 1e-9);
}

#[test]
fn the_committed_reference_table_is_that_of_the_reference_arm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = ArmFile::load(&folder.join("planar-6.toml")).expect("the reference table is committed");
    let arm = ArmFile::load(&folder.join("arms/planar-6.toml")).expect("the description is committed");
    assert_eq!(table.bend_sensors().expect("it is a table"), [2; 6]);
    assert_eq!(table.arm, arm.arm);
    for (segment, of_arm) in table.segments.iter().zip(&arm.segments) {
        assert_eq!(segment.length_mm.to_bits(), of_arm.length_mm.to_bits());
        assert_eq!(segment.offset_mm.to_bits(), of_arm.offset_mm.to_bits());
        assert_eq!(segment.offset_at, of_arm.offset_at);
    }
}

#[test]
fn the_committed_reference_table_is_as_it_would_be_written() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("planar-6.toml");
    let text = std::fs::read_to_string(path).expect("the reference table is committed");
    assert_eq!(parse(&text).to_toml(), text);
}

#[test]
fn the_embedded_description_is_an_arm_description() {
    let arm = parse(calibration_tables::PLANAR_6_ARM);
    assert!(matches!(arm.bend_sensors(), Err(FileError::NotCalibrated(1))));
}

#[test]
fn segments_without_limits_have_the_thresholds_of_the_arm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-tests/tables");
    let text = std::fs::read_to_string(folder.join("version-0.1.toml")).expect("the table is committed");
    let compiled = parse(&text).compile::<Q>(100.0).expect("it is a table");
    let config = compiled.config();
    assert!(config.segments.iter().all(|segment| segment.contact.is_none()));
    let contact = config.contact.expect("it is in the file");
    assert!((contact.coupling.rad().to_degrees() - 4.0).abs() < 1e-6);
}

#[test]
fn the_segment_with_more_play_and_lag_is_compared_with_the_other_behind_them() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("planar-6.toml"))
        .expect("the reference table is committed");
    let mut table = parse(&text);
    let limit = ChangeToml { change_deg: 4.0, motion_deg: 8.0 };
    let coupled = CoupledToml { lag_s: 0.1, play_deg: -1.0, limit: Some(limit), ..CoupledToml::with_ratio(1, 0.9) };
    table.segments[1].coupled_to = Some(coupled);
    let compiled = table.compile::<Q>(100.0).expect("it is a table");
    let limits = compiled.config().segments[1].contact.expect("it has a limit");
    let Coupling { lead, own, ratio_left, .. } = limits.coupling.expect("it is coupled");
    // A lag of one value: 1 − 1/e.
    assert_eq!((lead.play, lead.share), (0, 41_427));
    assert_eq!((own.play, own.share), (11_930_465, Response::PROMPT));
    assert_eq!(ratio_left, (0.9 * CoupledSegment::ONE).round() as i32, "that of the other side");
}

#[test]
fn tables_of_version_0_1_are_accepted_and_written_with_the_keys_of_today() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-tests/tables");
    for name in ["version-0.1.toml", "version-0.1-anchor.toml"] {
        let text = std::fs::read_to_string(folder.join(name)).expect("the table is committed");
        let table = parse(&text);
        let [first, second, ..] = &table.segments[..] else { panic!("six segments") };
        assert!(first.coupled_to.is_none() && second.coupled_to.is_some(), "{name}: alike");
        let contact = table.contact.as_ref().expect("it is in the file");
        assert!((contact.coupling_deg - 4.0).abs() < f64::EPSILON, "{name}: alike_deg");
        let drift = table.drift.as_ref().expect("it is in the file");
        assert!((drift.rate_random_walk_deg_per_s_sqrt_s - 2e-4).abs() < f64::EPSILON, "{name}: walk_deg_per_s");
        let written = table.to_toml();
        assert_eq!(parse(&written), table);
        for old in ["alike", "half_width_deg", "drift_share", "gate_deg", "patience_s"] {
            assert!(!written.contains(old), "{name}: {old} is written again");
        }
    }
}
