//! The session check in the commands that make a table or truth of a session.

use super::common::{Csv, Folder, arm, simulate, sweep, table};

fn one_channel(session: &mut Csv) {
    let other: Vec<String> = session.rows.iter().map(|row| row[session.column("imu3_deg")].clone()).collect();
    session.map("imu4_deg", |row, _| other[row].clone());
}

/// The warnings about a file in `stderr`.
fn warnings<'s>(stderr: &'s str, file: &str) -> Vec<&'s str> {
    let start = format!("warning: {file}: ");
    stderr.lines().filter_map(|line| line.strip_prefix(&start)).collect()
}

#[test]
fn a_good_sweep_has_no_finding_in_calibrate_and_tune() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    for command in [
        ["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"],
        ["tune", "sweep.csv", "--table", "table.toml", "-o", "tuned.toml"],
    ] {
        let stderr = folder.done(&command).stderr;
        assert!(!stderr.contains(", row"), "{command:?}: {stderr}");
    }
}

/// The last value of an IMU is repeated for 6 s, which hardly moves the maps.
#[test]
fn calibrate_warns_by_the_table_that_it_makes() {
    let mut session = sweep();
    let value = session.cell(3000, "imu6_deg").to_owned();
    session.map("imu6_deg", |row, cell| if (3000..3300).contains(&row) { value.clone() } else { cell.to_owned() });
    let folder = Folder::with("sweep.csv", session.to_string());
    let run = folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    let found = warnings(&run.stderr, "sweep.csv").into_iter().find(|line| line.starts_with("imu6, rows 3001 to 3300"));
    assert!(found.is_some_and(|line| line.contains("the last value is repeated")), "{}", run.stderr);
}

/// Without maps: the error is about the truth, the finding has the reason.
#[test]
fn a_refused_sweep_has_its_findings_above_the_error() {
    let mut session = sweep();
    one_channel(&mut session);
    let folder = Folder::with("sweep.csv", session.to_string());
    let run = folder.run(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    let [same] = warnings(&run.stderr, "sweep.csv")[..] else { panic!("{}", run.stderr) };
    assert!(same.starts_with("imu3 and imu4, ") && same.contains("one multiplexer channel"), "{same}");
    assert!(run.stderr.find("warning: ") < run.stderr.find("error: "), "{}", run.stderr);
}

#[test]
fn an_imu_that_never_changes_is_found_without_a_table() {
    let mut session = sweep();
    session.map("imu5_deg", |_, _| "123.0000".to_owned());
    let folder = Folder::with("sweep.csv", session.to_string());
    let run = folder.run(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    let found = warnings(&run.stderr, "sweep.csv");
    assert!(
        found.iter().any(|line| line.starts_with("imu5, rows 1 to 6000") && line.contains("never changes")),
        "{found:?}"
    );
}

#[test]
fn tune_warns_of_a_training_session() {
    let mut session = simulate("--scenario 1 --seconds 120 --seed 61");
    one_channel(&mut session);
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["tune", "session.csv", "--table", table(), "-o", "tuned.toml"]);
    let [same] = warnings(&run.stderr, "session.csv")[..] else { panic!("{}", run.stderr) };
    assert!(same.starts_with("imu3 and imu4, "), "{same}");
}

#[test]
fn align_warns_of_the_session() {
    let folder = Folder::new();
    let simulate = "simulate --scenario sweep --seconds 120 --seed 8 --camera camera.csv -o session.csv";
    folder.done(&simulate.split(' ').collect::<Vec<_>>());
    let align = |output| ["align", "session.csv", "--camera", "camera.csv", "--arm", arm(), "-o", output];
    assert!(!folder.done(&align("good.csv")).stderr.contains("warning"));
    let mut session = folder.csv("session.csv");
    one_channel(&mut session);
    folder.write("session.csv", session.to_string());
    let run = folder.run(&align("one-channel.csv"));
    let [same] = warnings(&run.stderr, "session.csv")[..] else { panic!("{}", run.stderr) };
    assert!(same.starts_with("imu3 and imu4, "), "{same}");
}

#[test]
fn check_takes_an_arm_description_as_well() {
    let mut session = simulate("--scenario 1 --seconds 60 --seed 61");
    one_channel(&mut session);
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["check", "session.csv", "--table", arm()]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(
        run.stdout.starts_with("session.csv: imu3 and imu4, ") && run.stdout.lines().count() == 1,
        "{}",
        run.stdout
    );
}
