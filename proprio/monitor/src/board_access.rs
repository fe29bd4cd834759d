//! The thread that waits for a board: it announces the monitor once it has a line, and takes the board's table.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use proprio_link::Link;
use proprio_session::NoProgress;

use super::access::Token;
use super::monitor_state::MonitorState;
use super::running::{Announcement, RunningMonitor};
use super::table::OwnedTable;
use crate::error::Error;

/// Time between two looks at the link.
const PERIOD: Duration = Duration::from_millis(100);

/// Time after a failed attempt to read a board's table.
const RETRY: Duration = Duration::from_secs(2);

/// State of the thread.
pub(super) struct BoardAccess {
    pub shared: Arc<MonitorState>,
    pub address: SocketAddr,
    /// Folder of the announcement.
    pub folder: Option<PathBuf>,
    /// Token for the user's programs.
    pub token: Option<Token>,
    /// Address of the stream to Foxglove, if there is one.
    pub stream: Option<SocketAddr>,
}

impl BoardAccess {
    /// Works until `stop` is set; `announcement` is that of a line which is open already.
    pub fn run(self, link: &Link, mut announcement: Option<Announcement>, stop: &AtomicBool) {
        let (mut taken, mut due) = (0, Instant::now());
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(PERIOD);
            let state = link.state();
            if let (None, Some(line)) = (&announcement, state.port) {
                announcement = self.announce_line(line);
            }
            let Some(hello) = state.hello.filter(|_| state.is_connected) else { continue };
            if self.shared.sessions.is_table_given() || hello.table == taken || Instant::now() < due {
                continue;
            }
            match board_table(link, hello.table) {
                Ok(table) => {
                    self.shared.set_board_table(table);
                    taken = hello.table;
                }
                // The line may have lost it, or the board is busy.
                Err(_) => due = Instant::now() + RETRY,
            }
        }
    }

    /// Announces the monitor to this user's programs, where its line is open.
    pub fn announce(&self) -> Option<Announcement> {
        let line = self.shared.link.as_ref()?.state().port?;
        self.announce_line(line)
    }

    /// Without an announcement programs cannot use the monitor, which is no failure of the monitor.
    fn announce_line(&self, line: String) -> Option<Announcement> {
        let (folder, token) = (self.folder.as_deref()?, self.token.as_ref()?);
        let (address, stream) = (self.address, self.stream);
        Announcement::new(folder, &RunningMonitor { line, address, token: token.to_string(), stream }).ok()
    }
}

/// Reads the board's table with this checksum; `None` for checksum 0, which is that of a board without a table.
fn board_table(link: &Link, checksum: u32) -> Result<Option<OwnedTable>, Error> {
    if checksum == 0 {
        return Ok(None);
    }
    let pulled = proprio_link::table::pull(link, &mut NoProgress)?;
    OwnedTable::of_board(&pulled.toml)
}
