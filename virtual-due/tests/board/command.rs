//! The command `virtual-due run`, as a shell sees it.

use crate::program::{SPIN, WFI, elf, firmware};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// Runs a file of these bytes for a virtual second.
fn run(name: &str, bytes: &[u8]) -> Output {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).expect("a place for the firmware");
    Command::new(env!("CARGO_BIN_EXE_virtual-due"))
        .args(["run", "--seconds", "1"])
        .arg(path)
        .stdin(Stdio::null())
        .output()
        .expect("the command")
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
