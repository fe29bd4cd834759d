//! The tools as they are used: the virtual Due on a pseudo-terminal, and `proprio monitor` on that.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::{env, fs};

use tempfile::TempDir;

use crate::build::firmware;

/// A board, and a monitor of it.
pub struct MonitorRun {
    due: Option<(Child, ChildStdin)>,
    monitor: Child,
    /// What the monitor has printed.
    pub address: String,
    /// Where it records.
    pub folder: TempDir,
}

/// A tool of this workspace: beside this program, or above it, as cargo builds tests in `deps`.
fn tool(name: &str) -> PathBuf {
    let own = env::current_exe().expect("the system tells");
    let mut built = own.ancestors().skip(1).take(2).map(|folder| folder.join(name));
    built.find(|tool| tool.is_file()).unwrap_or_else(|| panic!("{name} is not built; `cargo verify` does"))
}

fn table() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml")
}

impl MonitorRun {
    /// A live board on a pseudo-terminal.
    ///
    /// # Panics
    /// If the tools are not built, or do not start.
    #[must_use]
    pub fn live(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        fs::write(folder.path().join("firmware"), firmware()).expect("there is room");
        let mut command = Command::new(tool("virtual-due"));
        command.current_dir(folder.path()).args(["run", "firmware", "--speed", "real", "--serial", "pty"]);
        command.stdin(Stdio::piped()).stderr(Stdio::piped());
        let mut due = command.spawn().expect("the emulator starts");
        let mut lines = BufReader::new(due.stderr.take().expect("a pipe")).lines().map_while(Result::ok);
        let first = lines.next().expect("it says its port");
        let port = first.strip_prefix("serial port: ").expect("the path of its port").to_owned();
        // It says more, which must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        let hand = due.stdin.take().expect("a pipe");
        let arguments = [&["--port", &port], arguments].concat();
        Self::start(folder, Some((due, hand)), &arguments)
    }

    /// A session and no board.
    ///
    /// # Panics
    /// As [`MonitorRun::live`].
    #[must_use]
    pub fn session(path: &Path) -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        Self::start(folder, None, &[path.to_str().expect("a path of this workspace")])
    }

    fn start(folder: TempDir, due: Option<(Child, ChildStdin)>, arguments: &[&str]) -> Self {
        let mut command = Command::new(tool("proprio"));
        command.current_dir(folder.path()).arg("monitor").args(arguments).args(["--listen", "0", "--table"]);
        command.arg(table()).stdin(Stdio::null()).stdout(Stdio::piped());
        let mut monitor = command.spawn().expect("the tool starts");
        let mut address = String::new();
        BufReader::new(monitor.stdout.take().expect("a pipe")).read_line(&mut address).expect("it prints its address");
        Self { due, monitor, address: address.trim().to_owned(), folder }
    }

    /// `unplug imu3`, `plug imu3`, `unplug bend2a`.
    ///
    /// # Panics
    /// If there is no board.
    pub fn hand(&mut self, line: &str) {
        let (_, hand) = self.due.as_mut().expect("there is a board");
        writeln!(hand, "{line}").expect("it runs");
    }

    /// The address without the token.
    #[must_use]
    pub fn origin(&self) -> &str {
        self.address.split("/#").next().unwrap_or_default().trim_end_matches('/')
    }
}

impl Drop for MonitorRun {
    fn drop(&mut self) {
        let due = self.due.as_mut().map(|(due, _)| due);
        for process in [Some(&mut self.monitor), due].into_iter().flatten() {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}
