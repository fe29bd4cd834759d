//! The program `virtual-due` with the firmware, on a pseudo-terminal, as a process of its own.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};

use crate::build::firmware;
use crate::flash::{flash_with, stored_table};

/// Path of a tool of this workspace: in this program's folder, or the one above, as cargo builds tests in `deps`.
///
/// # Panics
/// If it is not built.
#[must_use]
pub fn tool(name: &str) -> PathBuf {
    let own = env::current_exe().expect("the program's own path");
    let mut built = own.ancestors().skip(1).take(2).map(|folder| folder.join(name));
    built.find(|tool| tool.is_file()).unwrap_or_else(|| panic!("{name} is not built; `cargo verify` does"))
}

/// A board in real time, until it is dropped.
pub struct DueProcess {
    child: Child,
    faults: ChildStdin,
    /// Path of its serial port.
    pub port: String,
}

impl DueProcess {
    /// Starts one with the reference arm's table in a folder, in which it leaves the firmware.
    ///
    /// # Panics
    /// If it is not built, or does not start.
    #[must_use]
    pub fn start(folder: &Path) -> Self {
        fs::write(folder.join("flash"), flash_with(&stored_table())).expect("there is room");
        Self::run(folder, &["--flash", "flash"])
    }

    /// Starts one without a table.
    ///
    /// # Panics
    /// As [`DueProcess::start`].
    #[must_use]
    pub fn without_table(folder: &Path) -> Self {
        Self::run(folder, &[])
    }

    fn run(folder: &Path, arguments: &[&str]) -> Self {
        fs::write(folder.join("firmware"), firmware()).expect("there is room");
        let mut command = Command::new(tool("virtual-due"));
        command.current_dir(folder).args(["run", "firmware", "--speed", "real", "--serial", "pty"]).args(arguments);
        let mut child = command.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the emulator starts");
        let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines().map_while(Result::ok);
        let first = lines.next().expect("the emulator prints its port");
        let port = first.strip_prefix("serial port: ").expect("the path of its port").to_owned();
        // Further lines must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        let faults = child.stdin.take().expect("a pipe");
        Self { child, faults, port }
    }

    /// Injects a fault: `imu3:unplugged`, `clear imu3:unplugged`, `bend2a:open`.
    ///
    /// # Panics
    /// If it has ended.
    pub fn inject_fault(&mut self, line: &str) {
        writeln!(self.faults, "{line}").expect("it runs");
    }
}

impl Drop for DueProcess {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
