//! `proprio drive` and `record` through the monitor that has the board's port: the pressures end vented, however the drive ends.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::drive::{ended, is_vented, run, start};
use crate::page::Page;
use crate::terminal::Terminal;
use crate::tools::{Running, folder, proprio, replayed, table};

/// Time of the board at which it is tared, s.
const TARED_S: f64 = 4.0;

/// A tared board whose port a monitor has.
fn monitored(name: &str) -> (PathBuf, Terminal, Page) {
    let folder = folder(name);
    let mut terminal = Terminal::new();
    let page = Page::of(&mut proprio(&folder, &["monitor", "--listen", "0", "--port", terminal.port()]));
    terminal.run_until(|machine| machine.seconds() > TARED_S);
    (folder, terminal, page)
}

/// Drives 80 kPa through the monitor until the board has them.
fn driven(folder: &Path, terminal: &mut Terminal) -> Running {
    let drive = start(folder, terminal, &["--kpa", "80,0,0,0,0,80"]);
    terminal.run_until(|machine| machine.world().set_points_pa()[5] > 79_000.0);
    drive
}

fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill starts").success());
}

#[test]
fn a_drive_and_a_recording_through_one_monitor_both_replay_bit_for_bit() {
    let (folder, mut terminal, _page) = monitored("drive and record");
    let arguments = ["record", "--port", terminal.port(), "-o", "record.mcap", "--table", &table()];
    let mut record = Running(proprio(&folder, &arguments).stderr(Stdio::piped()).spawn().expect("the tool starts"));
    terminal.run_until(|_| folder.join("record.mcap").is_file());
    let mut drive = start(&folder, &terminal, &["profile.csv", "--ramp", "150", "-o", "drive.mcap"]);
    let mut highest_pa = 0.0_f64;
    run(&mut terminal, &mut drive.0, |set_points| highest_pa = highest_pa.max(set_points[0]));
    assert!((59_900.0..=60_000.0).contains(&highest_pa) && is_vented(&terminal), "{highest_pa}");
    let (code, messages) = ended(drive);
    assert!(code == Some(0) && messages.contains("through the monitor") && messages.contains(", vented"), "{messages}");
    interrupt(&record.0);
    run(&mut terminal, &mut record.0, |_| {});
    let (code, messages) = ended(record);
    assert!(code == Some(0) && messages.contains("0 frames lost, 0 damaged"), "{messages}");
    for name in ["drive.mcap", "record.mcap"] {
        let (equal, report) = replayed(&folder, name);
        assert!(equal > 100 && report.contains("\"not_compared\":0"), "{name}: {report}");
    }
}

#[test]
fn a_drive_through_a_monitor_that_is_killed_leaves_the_arm_vented_within_one_and_a_half_seconds() {
    let (folder, mut terminal, _page) = monitored("monitored drive killed");
    drop(driven(&folder, &mut terminal));
    vents_by_its_deadline(&mut terminal);
}

#[test]
fn a_monitor_that_is_killed_ends_the_drive_through_it_and_leaves_the_arm_vented_within_one_and_a_half_seconds() {
    let (folder, mut terminal, page) = monitored("monitor killed");
    let mut drive = driven(&folder, &mut terminal);
    drop(page);
    vents_by_its_deadline(&mut terminal);
    run(&mut terminal, &mut drive.0, |_| {});
    let (code, messages) = ended(drive);
    assert_eq!(code, Some(2), "{messages}");
    assert!(messages.contains("through which the board was reached, has ended"), "{messages}");
}

/// The board vents now by its own rule: it holds the pressures first.
fn vents_by_its_deadline(terminal: &mut Terminal) {
    let begin_s = terminal.machine.seconds();
    terminal.run_until(|machine| machine.seconds() > begin_s + 0.25);
    assert!(!is_vented(terminal), "nothing but the deadline vents");
    terminal.run_until(|machine| machine.seconds() > begin_s + 1.5);
    assert!(is_vented(terminal));
}

#[test]
fn an_interrupt_of_a_drive_through_a_monitor_vents_at_once() {
    let (folder, mut terminal, _page) = monitored("monitored drive interrupted");
    let mut drive = driven(&folder, &mut terminal);
    interrupt(&drive.0);
    let interrupted_s = terminal.machine.seconds();
    terminal.run_until(|machine| machine.world().set_points_pa()[0] < 1.0);
    // It would be held for longer if the board had done it.
    assert!(terminal.machine.seconds() < interrupted_s + 0.5);
    run(&mut terminal, &mut drive.0, |_| {});
    let (code, messages) = ended(drive);
    assert!(code == Some(0) && messages.contains(", vented"), "{messages}");
}

#[test]
fn a_second_drive_is_refused_and_does_not_disturb_the_first() {
    let (folder, mut terminal, _page) = monitored("two drives");
    let mut first = driven(&folder, &mut terminal);
    let mut second = start(&folder, &terminal, &["--kpa", "0,0,0,0,0,0", "-o", "second.mcap"]);
    let mut lowest_pa = f64::INFINITY;
    run(&mut terminal, &mut second.0, |set_points| lowest_pa = lowest_pa.min(set_points[5]));
    let (code, messages) = ended(second);
    assert_eq!(code, Some(2), "{messages}");
    assert!(messages.contains("the arm is driven by another program"), "{messages}");
    assert!(!folder.join("second.mcap").exists());
    let after_s = terminal.machine.seconds() + 1.0;
    terminal.run_until(|machine| {
        lowest_pa = lowest_pa.min(machine.world().set_points_pa()[5]);
        machine.seconds() > after_s
    });
    assert!(lowest_pa > 79_000.0, "{lowest_pa} Pa");
    assert_eq!(first.0.try_wait().expect("its state is readable"), None);
}
