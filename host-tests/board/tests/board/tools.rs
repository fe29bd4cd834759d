//! The tools of this workspace, as users run them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use board_tests::due::tool;
use board_tests::firmware;

/// A folder below cargo's own, with the firmware in it.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Left by a run before.
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("cargo's folder can be written to");
    fs::write(folder.join("firmware"), firmware()).expect("there is room");
    folder
}

/// The tool in a folder, in which it finds the monitors that run there.
pub fn proprio(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(tool("proprio"));
    command.env("XDG_RUNTIME_DIR", folder);
    command.current_dir(folder).args(arguments).stdin(Stdio::null()).env("PROPRIO_VIRTUAL_DUE", tool("virtual-due"));
    command
}

/// Runs it to its end, which must be a success; returns its output.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = proprio(folder, arguments).output().expect("the tool starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("the tool writes UTF-8")
}

/// A process that ends with the test.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub fn table() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml").display().to_string()
}

/// Replays a recording; every estimate that can be compared must be the board's. Returns their number and the report.
pub fn replayed(folder: &Path, name: &str) -> (u64, String) {
    let report = done(folder, &["replay", name, "--table", &table(), "--json"]);
    let count = |key: &str| {
        let value = report.split_once(&format!("\"{key}\":")).expect("the key is there").1;
        let digits: String = value.chars().take_while(char::is_ascii_digit).collect();
        digits.parse::<u64>().expect("a count")
    };
    // Estimates that an earlier run of the board left on the line lack their first sample.
    assert_eq!(count("equal"), count("estimates") - count("not_compared"), "{report}");
    assert!(report.contains("\"first_difference\":null"), "{report}");
    (count("equal"), report)
}
