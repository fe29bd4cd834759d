//! Faults that the user injects while the board runs: at the times of a file, and by lines on standard input.

use std::io::{BufRead, stdin};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};

use super::error::Error;
use rig_twin::{Fault, FaultError, parse_schedule};
use virtual_due::{FaultSchedule, Machine, WiredRig};

/// Source of faults.
#[derive(Default)]
pub struct FaultInjector {
    schedule: FaultSchedule,
    /// Lines of standard input, where that is not the serial line.
    lines: Option<Receiver<String>>,
}

impl FaultInjector {
    /// Reads the faults of a file, and checks that this board can have them.
    pub fn of_file(path: &Path, machine: &Machine<WiredRig>) -> Result<Self, Error> {
        let shown = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| Error::FaultFile { path: shown.clone(), error })?;
        let at = |(line, error)| Error::Fault { path: shown.clone(), line, error };
        let faults = parse_schedule(&text).map_err(at)?;
        let checked = faults.into_iter().map(|(line, timed)| {
            machine.check(timed.fault).map_err(|error| at((line, error)))?;
            Ok(timed)
        });
        Ok(Self { schedule: FaultSchedule::new(checked.collect::<Result<_, Error>>()?), lines: None })
    }

    /// Starts to read lines of standard input, too.
    #[cfg(unix)]
    pub fn reading_stdin(self) -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self { lines: Some(lines), ..self }
    }

    /// Begins and ends the faults that are due; prints the lines that it cannot parse.
    pub fn apply(&mut self, machine: &mut Machine<WiredRig>) {
        // Checked when the file was read.
        if let Err(error) = self.schedule.apply(machine) {
            eprintln!("{error}");
        }
        for line in self.lines.iter().flat_map(Receiver::try_iter) {
            if let Err(error) = apply(line.trim(), machine) {
                eprintln!("{line}: {error}");
            }
        }
    }
}

fn apply(line: &str, machine: &mut Machine<WiredRig>) -> Result<(), FaultError> {
    let (fault, is_end) = command(line)?;
    machine.check(fault)?;
    if is_end {
        machine.clear(fault);
        return Ok(());
    }
    machine.inject(fault)
}

/// The fault of a line, and whether it ends: `FAULT`, `clear FAULT`, `unplug SENSOR`, `plug SENSOR`.
fn command(line: &str) -> Result<(Fault, bool), FaultError> {
    let lost = |sensor: &str| {
        let fault = if sensor.starts_with("bend") { "open" } else { "unplugged" };
        format!("{sensor}:{fault}").parse()
    };
    match line.split_once(' ') {
        Some(("clear", fault)) => Ok((fault.parse()?, true)),
        Some(("unplug", sensor)) => Ok((lost(sensor)?, false)),
        Some(("plug", sensor)) => Ok((lost(sensor)?, true)),
        _ => Ok((line.parse()?, false)),
    }
}

#[cfg(test)]
mod tests {
    use super::command;

    #[test]
    fn sensors_are_unplugged_and_plugged_in_by_name() {
        for (line, expected) in [
            ("unplug imu3", "imu3:unplugged"),
            ("plug imu3", "imu3:unplugged"),
            ("unplug bend6b", "bend6b:open"),
            ("plug bend6b", "bend6b:open"),
            ("imu3:jump=30", "imu3:jump=30"),
            ("clear sda:held", "sda:held"),
        ] {
            let is_end = line.starts_with("plug") || line.starts_with("clear");
            assert_eq!(
                command(line).map(|(fault, is_end)| (fault.to_string(), is_end)),
                Ok((expected.to_owned(), is_end))
            );
        }
        for line in ["", "unplug", "unplug imu0", "unplug imu9", "unplug bend9a", "unplug bend1c", "pull imu1"] {
            assert!(command(line).is_err(), "{line}");
        }
    }
}
