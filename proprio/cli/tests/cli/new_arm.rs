//! `new-arm`, and `check` of arm descriptions and tables: what is written, printed and refused.

use calibration_tables::ArmFile;

use super::common::{Folder, Run, json, session, table};

const THREE: [&str; 9] =
    ["new-arm", "--lengths-mm", "90,80.5,70", "--bend", "2,0,1", "--regulators", "2", "-o", "arm.toml"];

/// The first cells of each line that has a number first.
fn rows(run: &Run) -> Vec<Vec<&str>> {
    let cells = run.stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    cells.filter(|cells| cells.first().is_some_and(|cell| cell.parse::<u32>().is_ok())).collect()
}

#[test]
fn a_new_arm_is_described_and_its_wiring_is_printed() {
    let folder = Folder::new();
    let run = folder.done(&THREE);
    let file = ArmFile::load(&folder.path("arm.toml")).expect("an arm description");
    assert_eq!((file.arm.as_str(), file.segments.len()), ("arm", 3));
    let address = ["address", "0x28"];
    let expected = [
        [&["1", "A0", "A1", "channel", "0,"][..], &address].concat(),
        [&["2", "-", "-", "channel", "1,"][..], &address].concat(),
        [&["3", "A2", "-", "channel", "2,"][..], &address].concat(),
        vec!["1", "D6", "280"],
        vec!["2", "D7", "280"],
    ];
    assert_eq!(rows(&run), expected);
}

#[test]
fn check_prints_the_same_wiring_as_new_arm() {
    let folder = Folder::new();
    let made = folder.done(&THREE);
    let checked = folder.done(&["check", "arm.toml"]);
    assert!(checked.stdout.contains(&made.stdout), "{}", checked.stdout);
    let counts = "arm.toml: description of arm arm: 3 segments, 3 bend sensors, 3 IMUs, 2 regulators\n";
    assert!(checked.stdout.starts_with(counts), "{}", checked.stdout);
}

#[test]
fn options_name_the_arm_and_set_the_full_scale() {
    let folder = Folder::new();
    let options = ["--name", "my \"arm\"", "--full-scale-kpa", "100.5"];
    let run = folder.done(&[&THREE[..], &options].concat());
    assert!(run.stdout.contains("100.5"), "{}", run.stdout);
    let file = ArmFile::load(&folder.path("arm.toml")).expect("an arm description");
    assert_eq!(file.arm, "my \"arm\"");
}

#[test]
fn a_missing_option_is_named_where_nobody_can_be_asked() {
    let folder = Folder::new();
    assert_eq!(folder.refused(&["new-arm", "-o", "arm.toml"]), "--lengths-mm is missing");
    assert_eq!(folder.refused(&["new-arm", "--lengths-mm", "90", "-o", "arm.toml"]), "--bend is missing");
}

#[test]
fn an_arm_that_the_board_has_no_room_for_is_refused() {
    let folder = Folder::new();
    let refused = |lengths: &str, bend: &str, more: &[&str]| {
        folder.refused(&[&["new-arm", "--lengths-mm", lengths, "--bend", bend, "-o", "arm.toml"][..], more].concat())
    };
    let cases = [
        (refused("9,9,9,9,9,9,9,9,9", "0,0,0,0,0,0,0,0,0", &[]), "--lengths-mm has 9 segments, expected 1 to 8"),
        (refused("9,9,9,9,9,9,9", "2,2,2,2,2,2,1", &[]), "--bend has 13 bend sensors in all, expected at most 12"),
        (refused("90", "3", &[]), "--bend: segment 1 has 3 bend sensors, expected 0 to 2"),
        (refused("90,90", "1", &[]), "--bend has 1 segments, expected the 2 of --lengths-mm"),
        (refused("90,-1", "1,1", &[]), "--lengths-mm: segment 2 has -1 mm"),
        (refused("90", "1", &["--regulators", "9"]), "--regulators 9, expected 0 to 8"),
        (refused("90", "1", &["--full-scale-kpa", "0"]), "--full-scale-kpa 0, expected 0.001 to 1000"),
    ];
    for (error, expected) in cases {
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn a_description_that_is_there_is_kept_without_force() {
    let folder = Folder::with("arm.toml", "mine");
    assert!(folder.refused(&THREE).contains("arm.toml"));
    folder.done(&[&THREE[..], &["--force"]].concat());
    assert!(folder.read("arm.toml").contains("[board]"));
}

#[test]
fn a_description_on_standard_output_has_no_wiring_table_between() {
    let folder = Folder::new();
    let run = folder.done(&["new-arm", "--lengths-mm", "90", "--bend", "1", "-o", "-"]);
    ArmFile::parse(&run.stdout).expect("an arm description alone");
    assert!(run.stderr.contains("bend sensor a"), "{}", run.stderr);
}

/// docs/reference/protocol.md: 100 · (25 + 12 N) bytes of samples, and the same of estimates with 16 bytes.
#[test]
fn check_states_the_load_of_the_line_and_the_rate_of_the_estimates() {
    let folder = Folder::new();
    folder.done(&THREE);
    let eight = ["new-arm", "--lengths-mm", "9,9,9,9,9,9,9,9", "--bend", "2,2,2,2,1,1,1,1", "-o", "eight.toml"];
    folder.done(&eight);
    let arms = json(&folder.done(&["check", "arm.toml", "eight.toml", "--json"]));
    let line = |arm: usize| arms[arm]["line_bytes_per_s"].clone();
    assert_eq!((&line(0)["samples"], &line(0)["estimate_hz"]), (&6_100.into(), &100.into()));
    assert_eq!((&line(1)["samples"], &line(1)["estimate_hz"]), (&12_100.into(), &50.into()));
    let text = folder.done(&["check", "eight.toml"]).stdout;
    assert!(text.contains("estimates, 50 Hz") && text.contains("every second one"), "{text}");
}

#[test]
fn a_table_without_a_wiring_is_shown_with_the_reference_wiring() {
    let run = Folder::new().done(&["check", table()]);
    let pins: Vec<_> = rows(&run).iter().take(6).map(|cells| cells[1..3].join(" ")).collect();
    assert_eq!(pins, ["A0 A1", "A2 A3", "A4 A5", "A6 A7", "A8 A9", "A10 A11"]);
}

#[test]
fn a_wrong_pin_of_a_description_is_named_with_its_key() {
    let folder = Folder::new();
    folder.done(&THREE);
    folder.write("arm.toml", folder.read("arm.toml").replace("\"A2\"", "\"A12\""));
    let error = folder.refused(&["check", "arm.toml"]);
    assert!(error.contains("board.segment[3].bend = pin A12, expected one of A0 to A11"), "{error}");
}

#[test]
fn an_arm_and_a_session_are_checked_in_one_run() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.done(&THREE);
    let checked = json(&folder.done(&["check", "arm.toml", "session.csv", "--table", table(), "--json"]));
    assert_eq!((&checked[0]["segments"], &checked[1]["path"]), (&3.into(), &"session.csv".into()));
}

#[test]
fn a_session_is_not_checked_without_a_table() {
    let folder = Folder::with("session.csv", session().to_string());
    let error = folder.refused(&["check", "session.csv"]);
    assert!(error.starts_with("session.csv: ") && error.contains("table"), "{error}");
}

/// docs/how-to/wiring.md: the command, its wiring table, and the section `[board]` that it writes.
#[test]
fn the_first_example_of_the_wiring_page_is_what_new_arm_makes() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/how-to/wiring.md"));
    let page = page.expect("the page is committed");
    let command = page.lines().find_map(|line| line.strip_prefix("    proprio new-arm ")).expect("the command");
    let folder = Folder::new();
    let run = folder.done(&["new-arm"].into_iter().chain(command.split(' ')).collect::<Vec<_>>());
    assert!(page.contains(&format!("```text\n{}```", run.stdout)), "{}", run.stdout);
    let section = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("the section");
    let written = ArmFile::load(&folder.path("arm.toml")).expect("an arm description");
    let text = folder.read("arm.toml");
    let (head, rest) = text.split_once("[board]").expect("the section");
    let (_, segments) = rest.split_once("[[segment]]").expect("the segments");
    let of_page = ArmFile::parse(&format!("{head}{section}[[segment]]{segments}")).expect("the section is valid");
    assert_eq!(written.board, of_page.board);
}
