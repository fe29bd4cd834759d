//! A running monitor, for this user's other programs: they reach the board through it while it has the board's line.
//!
//! A monitor writes its line, address and a token of its own into a file that only its user can read, and removes it at its end.

use std::fs::{self, OpenOptions};
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use proprio_link::status::Status;
use proprio_link::table::TableOnBoard;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use telemetry::TareMode;

use crate::actions::TareOutcome;

/// Begin of the name of each monitor's file.
const PREFIX: &str = "proprio-monitor-";

/// Longest wait for an answer: a silent board has ten seconds for its status.
const TIMEOUT: Duration = Duration::from_secs(40);

/// A running monitor. Without `Debug`, so that its token is not logged.
#[derive(Serialize, Deserialize)]
pub struct RunningMonitor {
    /// Name of the board's line.
    pub(super) line: String,
    pub(super) address: SocketAddr,
    /// Token that permits this user's programs to change the board's tare and table, and to drive its pressures.
    pub(super) token: String,
    /// Address of its stream to Foxglove, if there is one.
    pub(super) stream: Option<SocketAddr>,
}

/// Reason why a monitor did not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum RunningMonitorError {
    /// It does not answer.
    #[error("the monitor at http://{address} does not answer: {source}")]
    NoAnswer {
        /// Its address.
        address: SocketAddr,
        /// The reason.
        source: io::Error,
    },
    /// It has refused, or the board has.
    #[error("the monitor at http://{address}: {reason}")]
    Refused {
        /// Its address.
        address: SocketAddr,
        /// Its reason.
        reason: String,
    },
    /// The arm moves, and was not tared.
    #[error("{0}")]
    Moving(String),
}

/// The file of a monitor, which is removed when this is dropped.
#[derive(Debug)]
pub(super) struct Announcement(PathBuf);

impl Announcement {
    /// Announces a monitor in a folder of this user.
    pub fn new(folder: &Path, monitor: &RunningMonitor) -> io::Result<Self> {
        let path = folder.join(format!("{PREFIX}{}.json", monitor.address.port()));
        // What a monitor with this port has left that did not end in order.
        let _ = fs::remove_file(&path);
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&path)?;
        serde_json::to_writer(&mut file, monitor)?;
        Ok(Self(path))
    }
}

impl Drop for Announcement {
    fn drop(&mut self) {
        // A file that stays is of a monitor that does not answer, and is passed over.
        let _ = fs::remove_file(&self.0);
    }
}

impl RunningMonitor {
    /// The monitor that has this line, of those that are announced in `folder`.
    #[must_use]
    pub fn find(folder: &Path, line: &str) -> Option<Self> {
        let real = |name: &str| fs::canonicalize(name).unwrap_or_else(|_| name.into());
        let files = fs::read_dir(folder).ok()?.filter_map(Result::ok);
        let announced = files
            .filter(|file| file.file_name().to_string_lossy().starts_with(PREFIX))
            .filter_map(|file| serde_json::from_slice::<Self>(&fs::read(file.path()).ok()?).ok());
        let mut of_line = announced.filter(|monitor| real(&monitor.line) == real(line));
        of_line.find(|monitor| TcpStream::connect(monitor.address).is_ok())
    }

    /// Its address.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Address of its stream to Foxglove, if there is one.
    #[must_use]
    pub const fn stream(&self) -> Option<SocketAddr> {
        self.stream
    }

    /// The status of the board.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn status(&self) -> Result<Status, RunningMonitorError> {
        self.request("GET", "/board", "")
    }

    /// Tares the board; returns how still and how straight the arm was.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn tare(&self, mode: TareMode) -> Result<String, RunningMonitorError> {
        let request = serde_json::json!({"force": mode == TareMode::Force});
        let TareOutcome { is_moving, text } = self.request("POST", "/board/tare", &request.to_string())?;
        if is_moving { Err(RunningMonitorError::Moving(text)) } else { Ok(text) }
    }

    /// The table of the board.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn table(&self) -> Result<TableOnBoard, RunningMonitorError> {
        self.request("GET", "/board/table", "")
    }

    /// Text of the board's table.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn pull_table(&self) -> Result<String, RunningMonitorError> {
        self.request("GET", "/board/table.toml", "")
    }

    /// Stores a table, the text of its file, on the board, which restarts with it.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn push_table(&self, toml: &str) -> Result<TableOnBoard, RunningMonitorError> {
        self.request("POST", "/board/table", toml)
    }

    /// Erases the table of the board, which restarts without one.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn erase_table(&self) -> Result<(), RunningMonitorError> {
        self.request("DELETE", "/board/table", "")
    }

    fn request<T: DeserializeOwned>(&self, method: &str, path: &str, body: &str) -> Result<T, RunningMonitorError> {
        let address = self.address;
        let no_answer = |source| RunningMonitorError::NoAnswer { address, source };
        let answer = self.answer(method, path, body).map_err(no_answer)?;
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or_default();
        if head.split(' ').nth(1) != Some("200") {
            return Err(RunningMonitorError::Refused { address, reason: body.to_owned() });
        }
        serde_json::from_str(body).map_err(|error| no_answer(error.into()))
    }

    /// The answer of the server, with its head.
    fn answer(&self, method: &str, path: &str, body: &str) -> io::Result<String> {
        let Self { address, token, .. } = self;
        let mut stream = TcpStream::connect(address)?;
        stream.set_read_timeout(Some(TIMEOUT))?;
        let length = body.len();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nAuthorization: Bearer \
             {token}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
        )?;
        let mut answer = String::new();
        stream.read_to_string(&mut answer)?;
        Ok(answer)
    }
}
