//! `proprio drive`: the pressures follow a profile, and end vented, however the drive ends.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::terminal::Terminal;
use crate::tools::{Running, folder, proprio, replayed, table};

/// Half a second up to 60 kPa on module 1's right, a second of that, and a step down to 20 kPa on module 2's left.
const PROFILE: &str = "time_s,pressure1_kpa,pressure2_kpa,pressure3_kpa,pressure4_kpa,pressure5_kpa,pressure6_kpa\n\
    0,0,0,0,0,0,0\n1,60,0,0,0,0,0\n2,60,0,0,0,0,0\n2,0,0,0,20,0,0\n3,0,0,0,20,0,0\n";

/// A step of the PWM, Pa.
const STEP_PA: f64 = 67.0;

/// Starts a drive on the terminal's port.
pub fn start(folder: &Path, terminal: &Terminal, arguments: &[&str]) -> Running {
    fs::write(folder.join("profile.csv"), PROFILE).expect("there is room");
    let arguments = [&["drive", "--port", terminal.port()], arguments].concat();
    Running(proprio(folder, &arguments).stderr(Stdio::piped()).spawn().expect("the tool starts"))
}

/// Lets the board run until the drive has ended; the set-points of every slice go to `see`.
pub fn run(terminal: &mut Terminal, child: &mut Child, mut see: impl FnMut(&[f64])) {
    terminal.run_until(|machine| {
        see(&machine.world().set_points_pa());
        child.try_wait().expect("its state is readable").is_some()
    });
}

/// The exit status of a drive that has ended, and its messages.
pub fn ended(mut drive: Running) -> (Option<i32>, String) {
    let mut messages = String::new();
    drive.0.stderr.take().expect("a pipe").read_to_string(&mut messages).expect("the tool writes UTF-8");
    (drive.0.wait().expect("it has ended").code(), messages)
}

fn inject(terminal: &mut Terminal, fault: &str) {
    terminal.machine.inject(fault.parse().expect("a fault")).expect("the board can have it");
}

/// True where no regulator has a set-point.
pub fn is_vented(terminal: &Terminal) -> bool {
    terminal.machine.world().set_points_pa().iter().all(|pressure_pa| *pressure_pa < 1.0)
}

/// Drives 80 kPa, and does `end` to the tool once the board has them.
fn drive_and(name: &str, end: impl FnOnce(&mut Child)) -> (Terminal, Running) {
    let folder = folder(name);
    let mut terminal = Terminal::new();
    let mut drive = start(&folder, &terminal, &["--kpa", "80,0,0,0,0,80"]);
    terminal.run_until(|machine| machine.world().set_points_pa()[5] > 79_000.0);
    end(&mut drive.0);
    (terminal, drive)
}

#[test]
fn a_profile_is_followed_and_recorded_and_ends_vented() {
    let folder = folder("profile");
    let mut terminal = Terminal::new();
    let mut drive =
        start(&folder, &terminal, &["profile.csv", "--ramp", "150", "-o", "drive.mcap", "--table", &table()]);
    let (mut highest, mut before, mut longest_step) = ([0.0; 6], vec![0.0; 6], 0.0_f64);
    run(&mut terminal, &mut drive.0, |set_points| {
        for i in 0..6 {
            highest[i] = f64::max(highest[i], set_points[i]);
            longest_step = longest_step.max((set_points[i] - before[i]).abs());
        }
        before = set_points.to_vec();
    });
    assert!(is_vented(&terminal));
    let (code, messages) = ended(drive);
    assert_eq!(code, Some(0), "{messages}");
    for (found, asked) in highest.into_iter().zip([60e3, 0.0, 0.0, 20e3, 0.0, 0.0]) {
        assert!((found - asked).abs() <= STEP_PA, "{highest:?}");
    }
    // Set-points come every 50 ms, and may be late by as much.
    assert!(longest_step <= 15e3 + STEP_PA, "{longest_step} Pa at once");
    assert!(messages.contains("in a step before row 4") && messages.contains(", vented"), "{messages}");
    let (equal, report) = replayed(&folder, "drive.mcap");
    // How many there are depends on the speed of this machine.
    assert!(equal > 100 && report.contains("\"not_compared\":0"), "{report}");
}

#[test]
fn a_drive_that_is_killed_leaves_the_arm_vented_within_one_and_a_half_seconds() {
    let (mut terminal, mut drive) = drive_and("drive killed", |drive| drive.kill().expect("it runs"));
    drive.0.wait().expect("it ends");
    let killed_s = terminal.machine.seconds();
    terminal.run_until(|machine| machine.seconds() > killed_s + 0.25);
    assert!(!is_vented(&terminal), "nothing but the deadline vents");
    terminal.run_until(|machine| machine.seconds() > killed_s + 1.5);
    assert!(is_vented(&terminal));
}

#[test]
fn an_interrupt_vents_at_once() {
    let (mut terminal, mut drive) = drive_and("drive interrupted", |drive| {
        assert!(Command::new("kill").args(["-INT", &drive.id().to_string()]).status().expect("kill starts").success());
    });
    let interrupted_s = terminal.machine.seconds();
    terminal.run_until(|machine| machine.world().set_points_pa()[0] < 1.0);
    // It would be held for longer if the board had done it.
    assert!(terminal.machine.seconds() < interrupted_s + 0.5);
    run(&mut terminal, &mut drive.0, |_| {});
    let (code, messages) = ended(drive);
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains(", vented") && !messages.contains("before the end"), "{messages}");
}

#[test]
fn a_drive_ends_when_the_board_restarts() {
    let (mut terminal, mut drive) = drive_and("drive restarted", |_| {});
    terminal.machine.press_reset();
    run(&mut terminal, &mut drive.0, |_| {});
    let (code, messages) = ended(drive);
    assert_eq!(code, Some(2), "{messages}");
    assert!(messages.contains("restarted") && is_vented(&terminal), "{messages}");
}

/// Starts a drive on a board that must not be armed; returns its messages.
fn refused(name: &str, terminal: &mut Terminal, arguments: &[&str]) -> String {
    let folder = folder(name);
    let mut drive = start(&folder, terminal, arguments);
    run(terminal, &mut drive.0, |set_points| assert!(set_points.iter().all(|pressure_pa| *pressure_pa < 1.0)));
    let (code, messages) = ended(drive);
    assert_eq!(code, Some(2), "{messages}");
    assert!(!folder.join("drive.mcap").exists());
    messages
}

#[test]
fn a_board_with_another_table_is_not_armed() {
    let other = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/trunk-planar.toml").display().to_string();
    let messages =
        refused("drive table", &mut Terminal::new(), &["profile.csv", "--table", &other, "-o", "drive.mcap"]);
    assert!(messages.contains("the pressures stay vented") && messages.contains("another table"), "{messages}");
}

#[test]
fn a_board_without_any_imu_is_not_armed() {
    let mut terminal = Terminal::new();
    inject(&mut terminal, "sda:held");
    let messages = refused("drive blind", &mut terminal, &["profile.csv"]);
    assert!(messages.contains("no IMU reads well"), "{messages}");
}

#[test]
fn a_drive_ends_when_the_board_holds_the_pressures_back() {
    let mut terminal = Terminal::new();
    inject(&mut terminal, "bend2a:open");
    inject(&mut terminal, "bend2b:short");
    let messages = refused("drive held back", &mut terminal, &["--kpa", "80,0,80,0,80,0"]);
    assert!(messages.contains("the board keeps pressure 1 at 0.0 kPa"), "{messages}");
}
