//! The command `virtual-due run`, as a shell sees it.

use crate::program::{SPIN, WFI, elf, firmware};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A file of these bytes.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).expect("a place for the file");
    path
}

/// Runs a file of these bytes for a virtual second.
fn run(name: &str, bytes: &[u8]) -> Output {
    command(name, bytes).output().expect("the command")
}

fn command(name: &str, bytes: &[u8]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-due"));
    command.args(["run", "--seconds", "1"]).arg(file(name, bytes)).stdin(Stdio::null());
    command
}

/// Runs a program that sleeps, with an arm of this number of segments on its pins.
fn run_with_arm(name: &str, segments: usize) -> Output {
    let segment = "[[segment]]\nlength_mm = 80.0\noffset_mm = 17.0\noffset_at = \"end\"\n";
    let text = format!("format = 1\narm = \"other\"\nrate_hz = 10.0\n{}", segment.repeat(segments));
    let arm = file(&format!("{name}.toml"), text.as_bytes());
    let mut command = command(&format!("{name}.elf"), &firmware(&[WFI, SPIN], 0));
    command.arg("--arm").arg(arm).output().expect("the command")
}

fn messages(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn firmware_that_runs_to_the_end_is_a_success() {
    let output = run("sleeps.elf", &firmware(&[WFI, SPIN], 0));
    assert_eq!(output.status.code(), Some(0), "{}", messages(&output));
    assert!(messages(&output).starts_with("1.000 s in "), "{}", messages(&output));
}

#[test]
fn firmware_that_locks_up_is_a_failure_with_its_address() {
    // udf, in the program and in its fault's handler
    let output = run("locks-up.elf", &firmware(&[0xDE00], 0));
    assert_eq!(output.status.code(), Some(1));
    assert!(messages(&output).contains("locked up at pc 0x00080040"), "{}", messages(&output));
}

#[test]
fn binary_made_from_an_elf_file_is_refused_with_the_remedy() {
    let output = run("firmware.bin", &[0x00, 0x80, 0x08, 0x20, 0x41, 0x00, 0x08, 0x00]);
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("give the linker's output"), "{}", messages(&output));
}

#[test]
fn firmware_for_another_chip_is_refused_with_the_remedy() {
    let output = run("other.elf", &elf(0x0800_0000, &[0; 64]));
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("link with the Due's memory map"), "{}", messages(&output));
}

#[test]
fn arm_of_three_segments_can_be_on_the_pins() {
    let output = run_with_arm("three", 3);
    assert_eq!(output.status.code(), Some(0), "{}", messages(&output));
}

#[test]
fn arm_of_nine_segments_is_refused_with_the_remedy() {
    let output = run_with_arm("nine", 9);
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("nine.toml: 9 segments, expected 1 to 8; simulate"), "{}", messages(&output));
}

#[test]
fn file_that_describes_no_arm_is_refused_with_the_remedy() {
    let arm = file("none.toml", b"format = 1\n");
    let output = command("none.elf", &firmware(&[WFI, SPIN], 0)).arg("--arm").arg(arm).output().expect("the command");
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("--arm takes the arm's description or table"), "{}", messages(&output));
}
