//! `proprio flash` with a board that runs the firmware already, and a bossac that does nothing.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};

use board_tests::due::DueProcess;

use crate::tools::{done, folder, proprio, table};

#[test]
fn after_flashing_the_table_is_stored_and_verified_in_one_line() {
    let folder = folder("flash");
    let programs = folder.join("bin");
    fs::create_dir(&programs).expect("there is room");
    symlink("/bin/sh", programs.join("sh")).expect("there is room");
    fs::write(programs.join("bossac"), "#!/bin/sh\n").expect("there is room");
    fs::set_permissions(programs.join("bossac"), fs::Permissions::from_mode(0o755)).expect("it is ours");
    // The board has the reference arm's table.
    let toml = fs::read_to_string(table()).expect("the reference table").replacen("planar-6", "another arm", 1);
    fs::write(folder.join("table.toml"), &toml).expect("there is room");

    let due = DueProcess::start(&folder);
    let arguments = ["flash", "--table", "table.toml", "--port", &due.port, "--firmware", "firmware"];
    let output = proprio(&folder, &arguments).env("PATH", &programs).output().expect("the tool starts");
    let (result, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let begin = format!("flashed: {} runs firmware {} (", due.port, env!("CARGO_PKG_VERSION"));
    assert!(result.starts_with(&begin) && result.ends_with(" of arm another arm\n"), "{result}{errors}");
    assert_eq!((result.lines().count(), output.status.code()), (1, Some(0)), "{errors}");

    done(&folder, &["table", "pull", "--port", &due.port, "-o", "pulled.toml"]);
    assert_eq!(fs::read_to_string(folder.join("pulled.toml")).expect("it was pulled"), toml);
}
