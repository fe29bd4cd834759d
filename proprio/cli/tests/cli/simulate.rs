//! `simulate`: the same bytes from the same seed, the committed recordings among them.

use std::fs;
use std::path::Path;

use super::common::{Folder, arm, simulate};
use super::recordings::Recording;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the crate is in a workspace")
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    for scenario in ["1", "2", "3", "sweep"] {
        let args = format!("--scenario {scenario} --seconds 20 --seed 61");
        assert!(simulate(&args) == simulate(&args), "scenario {scenario}");
    }
}

#[test]
fn another_seed_gives_another_motion_and_other_noise() {
    let [one, other] = [62, 63].map(|seed| simulate(&format!("--scenario 1 --seconds 20 --seed {seed}")));
    assert_ne!(one.numbers("truth6_x_mm"), other.numbers("truth6_x_mm"));
    // At rest only the noise differs.
    assert_ne!(one.numbers("bend1a_adc")[..40], other.numbers("bend1a_adc")[..40]);
}

#[test]
fn scenarios_differ() {
    let [one, two, three] = [1, 2, 3].map(|k| simulate(&format!("--scenario {k} --seconds 30 --seed 64")));
    assert!(one != two && two != three && one != three);
}

/// The day of the committed table, s since 1970.
const DAY_OF_THE_TABLE_S: &str = "1795910400";

/// Every line of the list, in order, in an empty folder: this is how the recordings of the repository were made.
#[test]
fn the_committed_recordings_and_table_can_be_made_again_to_the_byte() {
    let folder = Folder::new();
    fs::create_dir(folder.path("arms")).expect("a temporary folder can be written to");
    fs::copy(arm(), folder.path("arms/planar-6.toml")).expect("the description is committed");
    let list = fs::read_to_string(root().join("host-tests/sessions/commands.txt")).expect("the list is committed");
    let mut compared = 0;
    for line in list.lines() {
        let args: Vec<&str> = line.split_whitespace().collect();
        let run = folder.command(&args).env("SOURCE_DATE_EPOCH", DAY_OF_THE_TABLE_S).output().expect("the tool starts");
        assert!(run.status.success(), "{line}: {run:?}");
        let name = *args.last().expect("a command");
        let committed = match name {
            "planar-6.toml" => root().join("calibration-tables").join(name),
            _ => root().join("host-tests/sessions").join(name),
        };
        if name == "sweep.csv" {
            continue;
        }
        let expected = fs::read_to_string(&committed).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = folder.read(name);
        for (number, (found, expected)) in (1..).zip(found.lines().zip(expected.lines())) {
            assert_eq!(found, expected, "line {number} of {name}");
        }
        assert!(found == expected, "{name}");
        compared += 1;
    }
    assert_eq!(compared, 5, "the table and four recordings");
}

#[test]
fn the_arm_rests_straight_for_five_seconds() {
    for scenario in ["1", "2", "3", "sweep"] {
        let session = simulate(&format!("--scenario {scenario} --seconds 30 --seed 65"));
        for i in 1..=6 {
            let heading = session.numbers(&format!("truth{i}_heading_deg"));
            assert!(heading[..50].iter().all(|heading| *heading == 0.0), "scenario {scenario}, segment {i}");
            let (x, y) = (session.numbers(&format!("truth{i}_x_mm")), session.numbers(&format!("truth{i}_y_mm")));
            // Four decimals, as written.
            let straight = |y: &f64| (y - 97.0 * f64::from(i)).abs() < 1e-4;
            assert!(x[..50].iter().all(|x| *x == 0.0) && y[..50].iter().all(straight));
        }
        let tip = session.numbers("truth6_x_mm");
        assert!(tip.iter().any(|x| x.abs() > 20.0), "scenario {scenario}: it moves then");
    }
}

#[test]
fn readings_are_within_the_range_of_their_sensors() {
    let session = simulate("--scenario 3 --seconds 60 --seed 66");
    for name in &session.names {
        let numbers = session.numbers(name);
        if name.ends_with("_adc") {
            assert!(numbers.iter().all(|counts| counts.fract() == 0.0 && (0.0..=4095.0).contains(counts)), "{name}");
        } else if name.starts_with("imu") {
            assert!(numbers.iter().all(|heading| (0.0..360.0).contains(heading)), "{name}");
        }
    }
}

#[test]
fn rate_and_seconds_give_the_rows_and_their_times() {
    let session = simulate("--scenario 1 --seconds 2 --seed 67 --rate 100");
    let times = session.numbers("time_s");
    assert_eq!(times.len(), 200);
    for (k, time) in times.iter().enumerate() {
        // Times are whole microseconds.
        assert!((time - k as f64 / 100.0).abs() < 1e-6, "row {k}: {time}");
    }
}

#[test]
fn the_lowest_and_the_highest_rate_are_accepted() {
    assert_eq!(simulate("--scenario 1 --seconds 3 --seed 68 --rate 1").rows.len(), 3);
    assert_eq!(simulate("--scenario 1 --seconds 0.5 --seed 68 --rate 1000").rows.len(), 500);
}

#[test]
fn quaternions_are_of_unit_length_and_have_the_headings() {
    let quaternions = simulate("--scenario 2 --seconds 20 --seed 69 --imu quaternion");
    let headings = simulate("--scenario 2 --seconds 20 --seed 69");
    assert!(!quaternions.has("imu1_deg") && !headings.has("imu1_qw"));
    let [w, x, y, z] = ["w", "x", "y", "z"].map(|part| quaternions.numbers(&format!("imu4_q{part}")));
    for (row, heading) in headings.numbers("imu4_deg").iter().enumerate() {
        let (w, x, y, z) = (w[row], x[row], y[row], z[row]);
        assert!((w * w + x * x + y * y + z * z - 1.0).abs() < 1e-3, "row {row}");
        let expected = -f64::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)).to_degrees();
        let turns = (heading - expected) / 360.0;
        // Half of the fifth decimal, and fixed point's atan2.
        assert!((turns - turns.round()).abs() * 360.0 < 6e-6, "row {row}: {heading}, expected {expected}");
    }
}

#[test]
fn arm_seed_zero_is_the_reference_arm_and_another_seed_another_arm() {
    let args = "--scenario 2 --seconds 20 --seed 70";
    let [zero, one] = [0, 1].map(|arm| simulate(&format!("{args} --arm-seed {arm}")));
    assert!(zero == simulate(args));
    assert_ne!(zero.numbers("truth6_y_mm"), one.numbers("truth6_y_mm"));
}

#[test]
fn motions_differ_and_swings_are_the_default() {
    let args = "--scenario 1 --seconds 20 --seed 71";
    let motions = ["swings", "slow", "fast", "one-module", "bent-start", "moving-start"];
    let sessions = motions.map(|motion| simulate(&format!("{args} --motion {motion}")));
    assert!(sessions[0] == simulate(args));
    for (index, session) in sessions.iter().enumerate() {
        assert!(!sessions[..index].contains(session), "{}", motions[index]);
    }
}

fn refused(name: &str, value: &str) -> String {
    let mut args = vec!["simulate", "--scenario", "1", "--seed", "1", "-o", "session.csv"];
    let option = format!("--{name}={value}");
    if name != "seconds" {
        args.push("--seconds=1");
    }
    args.push(&option);
    Folder::new().refused(&args)
}

#[test]
fn rates_that_cannot_be_sampled_are_refused() {
    for value in ["0", "0.5", "-10", "1001", "NaN", "inf"] {
        assert!(refused("rate", value).starts_with(&format!("--rate {value} Hz")), "{value}");
    }
}

#[test]
fn durations_that_cannot_be_simulated_are_refused() {
    for value in ["0", "-3", "1e9", "NaN", "inf"] {
        assert!(refused("seconds", value).starts_with("--seconds "), "{value}");
    }
}

#[test]
fn words_that_the_command_does_not_know_have_status_2() {
    for args in ["--scenario 4 --seconds 1 --seed 1", "--scenario 1 --seconds x --seed 1", "--scenario 1 --seconds 1"] {
        let folder = Folder::new();
        let mut all = vec!["simulate", "-o", "session.csv"];
        all.extend(args.split(' '));
        let run = folder.run(&all);
        assert_eq!(run.code, Some(2), "{args}");
        assert!(run.stdout.is_empty() && run.stderr.starts_with("error: "), "{args}: {}", run.stderr);
        assert!(!folder.path("session.csv").exists(), "{args}");
    }
}

#[test]
fn a_camera_takes_the_truth_out_of_the_session_and_changes_nothing_else() {
    for args in ["--scenario 2 --seconds 20 --seed 77", "--scenario 1 --seconds 3 --seed 77 --rate 130"] {
        let mut expected = simulate(args);
        expected.remove("truth");
        assert!(Recording::simulate(args).session == expected, "{args}");
    }
}

/// Frames of the arm that are dropped, and stamped by another clock; see `rig_twin::Camera`.
#[test]
fn the_camera_gives_30_frames_a_second_less_3_percent_in_order() {
    let camera = Recording::simulate("--scenario 1 --seconds 100 --seed 78").camera;
    assert!((2850..=2960).contains(&camera.rows.len()), "{}", camera.rows.len());
    let times = camera.numbers("time_s");
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    assert!((times[0] - 1.76e9).abs() < 0.1, "{}", times[0]);
}

#[test]
fn session_and_camera_are_two_files() {
    let args = ["simulate", "--scenario", "1", "--seconds", "1", "--seed", "1", "-o", "a.csv", "--camera"];
    let folder = Folder::new();
    assert!(folder.refused(&[&args[..], &["a.csv"]].concat()).starts_with("a.csv: cannot hold two outputs"));
    assert!(folder.refused(&[&args[..], &["none/b.csv"]].concat()).starts_with("none/b.csv: cannot be written"));
}
