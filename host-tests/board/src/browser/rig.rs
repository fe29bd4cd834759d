//! The tools as users run them: the virtual Due on a pseudo-terminal, and `proprio monitor` connected to it.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

use crate::due::{DueProcess, tool};

/// A board, and a monitor of it.
pub struct MonitorRun {
    due: Option<DueProcess>,
    monitor: Child,
    /// The page's address, as the monitor printed it.
    pub address: String,
    /// Folder of its recordings.
    pub folder: TempDir,
}

fn table() -> String {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml").to_owned()
}

impl MonitorRun {
    /// A live board on a pseudo-terminal.
    ///
    /// # Panics
    /// If the tools are not built, or do not start.
    #[must_use]
    pub fn live(arguments: &[&str]) -> Self {
        Self::of_board(&[arguments, &["--table", &table()]].concat())
    }

    /// A live board, whose table is known to the board alone.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[must_use]
    pub fn of_board(arguments: &[&str]) -> Self {
        Self::with_due(DueProcess::start, arguments)
    }

    /// A live board without a table.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[must_use]
    pub fn without_table() -> Self {
        Self::with_due(DueProcess::without_table, &[])
    }

    fn with_due(start: impl FnOnce(&Path) -> DueProcess, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let due = start(folder.path());
        let port = due.port.clone();
        let arguments = [&["--port", &port], arguments].concat();
        Self::start(folder, Some(due), &arguments)
    }

    /// A monitor of a board that is not there yet.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[must_use]
    pub fn waiting() -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        Self::start(folder, None, &["--port", "./board"])
    }

    /// Plugs in the board that a monitor waits for.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[cfg(unix)]
    pub fn plug_in(&mut self) {
        let due = DueProcess::start(self.folder.path());
        std::os::unix::fs::symlink(&due.port, self.folder.path().join("board")).expect("the folder can be written to");
        self.due = Some(due);
    }

    /// A session and no board.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[must_use]
    pub fn session(path: &Path) -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        Self::start(folder, None, &[path.to_str().expect("a path of this workspace"), "--table", &table()])
    }

    fn start(folder: TempDir, due: Option<DueProcess>, arguments: &[&str]) -> Self {
        let mut command = Command::new(tool("proprio"));
        command.current_dir(folder.path()).arg("monitor").args(arguments).args(["--listen", "0"]);
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        let mut monitor = command.spawn().expect("the tool starts");
        let mut address = String::new();
        BufReader::new(monitor.stdout.take().expect("a pipe")).read_line(&mut address).expect("it prints its address");
        Self { due, monitor, address: address.trim().to_owned(), folder }
    }

    /// Injects a fault: `unplug imu3`, `plug imu3`, `unplug bend2a`.
    ///
    /// # Panics
    /// If there is no board.
    pub fn inject_fault(&mut self, line: &str) {
        self.due.as_mut().expect("there is a board").inject_fault(line);
    }

    /// The address without the token.
    #[must_use]
    pub fn origin(&self) -> &str {
        self.address.split("/#").next().unwrap_or_default().trim_end_matches('/')
    }
}

impl Drop for MonitorRun {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.monitor.kill();
        let _ = self.monitor.wait();
    }
}
