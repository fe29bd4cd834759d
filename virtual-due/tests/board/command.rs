//! The command `virtual-due run`, as a shell sees it.

use crate::program::{SPIN, WFI, elf, firmware, load_r0};
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
    assert!(messages(&output).contains("pc 0x00080040: the core locked up"), "{}", messages(&output));
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

/// A firmware that sends `ok` on the programming port, at 250 000 Bd, and sleeps.
fn sends_ok() -> Vec<u8> {
    // PMC_PCER0 = UART; UART_BRGR = 1; UART_CR = TXEN; UART_THR = 'o'; until UART_SR.TXRDY; UART_THR = 'k'; wfi; b .
    let program = [
        0x4809, 0x21FF, 0x3101, 0x6101, 0x4808, 0x2101, 0x6201, 0x2140, 0x6001, 0x216F, 0x61C1, 0x6941, 0x0789, 0xD5FC,
        0x216B, 0x61C1, WFI, SPIN, SPIN, SPIN, 0x0600, 0x400E, 0x0800, 0x400E,
    ];
    firmware(&program, 0)
}

fn run_until(name: &str, arguments: &[&str]) -> Output {
    command(name, &sends_ok()).args(arguments).output().expect("the command")
}

#[test]
fn run_ends_with_success_at_its_text() {
    let output = run_until("until.elf", &["--until", "ok"]);
    assert_eq!((output.status.code(), &output.stdout[..]), (Some(0), &b"ok"[..]), "{}", messages(&output));
    // The line of the output ends before the summary.
    assert!(messages(&output).starts_with("\n0.002 s in "), "{}", messages(&output));
}

#[test]
fn run_that_ends_without_its_text_has_failed() {
    let output = run_until("never.elf", &["--until", "never"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(messages(&output).contains("did not hold \"never\", the text of --until"), "{}", messages(&output));
}

#[test]
fn run_fails_at_a_forbidden_text() {
    let output = run_until("fail-on.elf", &["--fail-on", "ok"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(messages(&output).contains("holds \"ok\", the text of --fail-on"), "{}", messages(&output));
}

/// A firmware that loads from nowhere, and sleeps in its fault's handler.
fn faults() -> Vec<u8> {
    // ldr r0, =0x400A8000; ldr r1, [r0]; b .; wfi; b -4
    firmware(&[load_r0(2), 0x6801, SPIN, WFI, 0xE7FC, 0, 0x8000, 0x400A], 3)
}

#[test]
fn report_is_a_failure_in_a_strict_run_alone() {
    let run = |arguments: &[&str]| command("reports.elf", &faults()).args(arguments).output().expect("the command");
    let strict = run(&["--strict"]);
    assert_eq!((run(&[]).status.code(), strict.status.code()), (Some(0), Some(1)), "{}", messages(&strict));
    assert!(messages(&strict).starts_with("0.000001 s, pc 0x00080042: bus fault"), "{}", messages(&strict));
}

#[test]
fn strict_run_without_a_report_is_a_success() {
    let output = command("strict.elf", &firmware(&[WFI, SPIN], 0)).arg("--strict").output().expect("the command");
    assert_eq!(output.status.code(), Some(0), "{}", messages(&output));
}

#[test]
fn truth_has_a_row_every_10_ms() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("truth.csv");
    let mut command = command("truth.elf", &firmware(&[WFI, SPIN], 0));
    let output = command.arg("--truth").arg(&path).output().expect("the command");
    assert_eq!(output.status.code(), Some(0), "{}", messages(&output));
    let text = std::fs::read_to_string(path).expect("the file");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0][..4], ["time_s", "truth1_x_mm", "truth1_y_mm", "truth1_heading_deg"]);
    assert_eq!((rows[0][18], rows[0][19], rows[0].len()), ("truth6_heading_deg", "setpoint1_kpa", 1 + 18 + 6));
    let times: Vec<&str> = rows[1..].iter().map(|row| row[0]).collect();
    assert_eq!((times.len(), times[0], times[1], times[100]), (101, "0.000", "0.010", "1.000"));
    // The reference arm hangs straight at first: 582 mm below its base.
    assert_eq!((rows[1][16], rows[1][17], rows[1][18]), ("0.000", "582.000", "0.0000"));
}
