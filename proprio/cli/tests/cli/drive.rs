//! Arguments that `proprio drive` refuses before it looks for a board.

use super::common::Folder;

const HEADER: &str = "time_s,pressure1_kpa,pressure2_kpa,pressure3_kpa,pressure4_kpa,pressure5_kpa,pressure6_kpa\n";

/// The error of a profile that would be driven on a port that is not there.
fn refused(profile: &str) -> String {
    let folder = Folder::with("profile.csv", profile);
    folder.refused(&["drive", "profile.csv", "--port", "/dev/no-such-port"])
}

#[test]
fn a_bad_cell_is_named_by_its_line_and_column() {
    let cases = [
        ("0,0,0,0,0,0,0\n1,0,x,0,0,0,0\n", "line 3, column pressure2_kpa: \"x\" is not a number"),
        ("0,0,0,0,0,0,\n", "line 2, column pressure6_kpa: the cell is empty, expected a pressure"),
        ("0,0,0,-1,0,0,0\n", "line 2, column pressure3_kpa: pressure -1, expected 0 to 1000 kPa"),
        ("0,1001,0,0,0,0,0\n", "line 2, column pressure1_kpa: pressure 1001, expected 0 to 1000 kPa"),
        ("0,0,0,0,0,nan,0\n", "line 2, column pressure5_kpa: nan is not finite; a missing reading is an empty cell"),
        ("1,0,0,0,0,0,0\n0.5,0,0,0,0,0,0\n", "line 3, column time_s: time goes backwards, from 1 s to 0.5 s"),
        (",0,0,0,0,0,0\n", "line 2, column time_s: the cell is empty, expected a time"),
        ("0,0,0\n", "line 2: the row has 3 cells, the header 7"),
    ];
    for (rows, expected) in cases {
        assert_eq!(refused(&format!("{HEADER}{rows}")), format!("profile.csv, {expected}"));
    }
}

#[test]
fn a_profile_lacks_no_regulator_and_has_rows() {
    let five = HEADER.replace(",pressure4_kpa", "") + "0,0,0,0,0,0\n";
    assert_eq!(refused(&five), "profile.csv, line 1: column pressure4_kpa is missing");
    let twice = HEADER.replace("pressure4", "pressure3") + "0,0,0,0,0,0,0\n";
    assert_eq!(refused(&twice), "profile.csv, line 1: column pressure3_kpa is there twice");
    assert_eq!(refused(HEADER), "profile.csv: has no pressures, expected a row for each point below the header");
    assert_eq!(refused(""), "profile.csv: is empty, expected a header line");
}

#[test]
fn a_good_profile_is_for_a_port_that_is_there() {
    let error = refused(&format!("{HEADER}0,0,0,0,0,0,0\n"));
    assert!(error.starts_with("/dev/no-such-port: cannot be opened"), "{error}");
}

#[test]
fn pressures_in_pa_are_taken_as_well() {
    let in_pa = HEADER.replace("kpa", "pa") + "0,0,0,0,0,0,1000001\n";
    assert_eq!(refused(&in_pa), "profile.csv, line 2, column pressure6_pa: pressure 1000001, expected 0 to 1000 kPa");
}

#[test]
fn arguments_out_of_range_are_refused() {
    let folder = Folder::with("d.mcap", "another recording");
    let refused = |arguments: &[&str]| folder.refused(&[&["drive", "--port", "/dev/no-such-port"], arguments].concat());
    assert_eq!(refused(&["--kpa", "0,0,0,1001,0,0"]), "--kpa 1001, expected 0 to 1000");
    assert_eq!(refused(&["--kpa", "0,0,0,0,0,0", "--ramp", "0"]), "--ramp 0 kPa/s, expected more than 0");
    assert!(refused(&["--kpa", "0,0,0,0,0,0", "--seconds", "-1"]).starts_with("--seconds -1, expected more than 0"));
    assert!(refused(&["--kpa", "0,0,0,0,0,0", "-o", "d.mcap"]).contains("d.mcap: is there already"));
}

#[test]
fn a_profile_has_as_many_regulators_as_its_columns() {
    let error = refused("time_s,pressure1_kpa,pressure2_kpa\n0,0,0\n");
    assert!(error.starts_with("/dev/no-such-port: cannot be opened"), "{error}");
    let nine = (1..=9).map(|i| format!(",pressure{i}_kpa")).collect::<Vec<_>>().concat();
    let error = refused(&format!("time_s{nine}\n0{}\n", ",0".repeat(9)));
    assert_eq!(error, "profile.csv, line 1: has pressures of 9 regulators, a board has 8 at most");
    let error = refused("time_s,pressure_kpa\n0,0\n");
    assert!(error.starts_with("profile.csv, line 1: column pressure1_kpa is missing"), "{error}");
    let folder = Folder::new();
    let run = folder.run(&["drive", "--port", "/dev/no-such-port", "--kpa", "0,0,0,0,0,0,0,0,0"]);
    assert!(run.stderr.contains("9 pressures, a board has 8 regulators at most"), "{}", run.stderr);
}
