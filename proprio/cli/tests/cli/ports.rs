//! `proprio ports`, and boards that are not there.

use super::common::{Folder, json};

#[test]
fn ports_are_a_table_or_json() {
    let folder = Folder::new();
    let ports = json(&folder.done(&["ports", "--json"]));
    let ports = ports.as_array().expect("a list");
    let table = folder.done(&["ports"]).stdout;
    for port in ports {
        assert!(table.contains(port["name"].as_str().expect("a name")), "{table}");
    }
    assert!(!table.is_empty());
}

#[test]
fn a_port_that_is_not_there_is_refused_by_name() {
    let error = Folder::new().refused(&["status", "--port", "/dev/no-such-port"]);
    assert!(error.starts_with("/dev/no-such-port: cannot be opened"), "{error}");
}

#[test]
fn the_speed_that_erases_the_board_is_refused() {
    let run = Folder::new().run(&["record", "--port", "/dev/null", "--baud", "1200", "-o", "a.mcap"]);
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("at 1200 Bd the Due erases its flash"), "{}", run.stderr);
}

#[test]
fn without_the_emulator_the_error_names_the_command_that_builds_it() {
    let folder = Folder::new();
    // Away from an emulator in the folder of the tool.
    let tool = folder.path("proprio");
    std::fs::copy(env!("CARGO_BIN_EXE_proprio"), &tool).expect("there is room");
    let mut command = std::process::Command::new(tool);
    command.args(["status", "--virtual"]).env("PATH", "").env_remove("PROPRIO_VIRTUAL_DUE");
    let output = command.output().expect("the tool starts");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("cargo virtual-due --version"), "{message}");
}

#[test]
fn the_udev_rules_name_the_programming_port_of_both_vendors_and_keep_modemmanager_away() {
    let rules = Folder::new().done(&["ports", "--udev"]).stdout;
    let mut lines = rules.lines().filter(|line| !line.starts_with('#'));
    for vendor in ["2341", "2a03"] {
        let due = format!("ATTRS{{idVendor}}==\"{vendor}\", ATTRS{{idProduct}}==\"003d\"");
        // ModemManager looks for its mark on the USB device, which is no tty.
        assert_eq!(lines.next(), Some(&format!("{due}, ENV{{ID_MM_DEVICE_IGNORE}}=\"1\"")[..]));
        let access = "MODE=\"0660\", GROUP=\"plugdev\", TAG+=\"uaccess\"";
        assert_eq!(lines.next(), Some(&format!("SUBSYSTEM==\"tty\", {due}, {access}")[..]));
    }
    assert_eq!(lines.next(), None);
}
