//! State that the threads of the monitor share.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use proprio_link::Link;
use proprio_session::HostClock;
use tokio::sync::broadcast;

use super::access::Token;
use super::feed::{ArmDescription, Feed};
use super::history::History;
use super::page_row::{self, ArmSize};
use super::recording::{Recording, RecordingProgress};
use super::sessions::Sessions;
use super::table::OwnedTable;
use crate::error::Error;

/// Capacity of a browser's queue, messages: one second. A slower browser loses the oldest.
const CAPACITY: usize = 128;

/// A message to every page.
#[derive(Debug, Clone)]
pub(super) enum Published {
    /// A batch of rows, with its time, µs by this program's clock.
    Rows(Utf8Bytes, u64),
    Status(Utf8Bytes),
    Arm(Utf8Bytes),
}

/// State that the threads of the monitor share.
#[derive(Debug)]
pub(super) struct MonitorState {
    pub link: Option<Link>,
    pub clock: HostClock,
    arm: Mutex<ArmDescription>,
    pub token: Option<Token>,
    /// Token of this user's programs; `None` where the monitor is not announced to them.
    pub program_token: Option<Token>,
    pub sessions: Sessions,
    pub help: fn(&Error) -> String,
    pub feed: broadcast::Sender<Published>,
    history: Mutex<History>,
    status: Mutex<Utf8Bytes>,
    recording: Mutex<Option<Recording>>,
    /// Number of tables that were taken from the board.
    board_tables: AtomicU32,
}

impl MonitorState {
    pub fn new(
        link: Option<Link>,
        arm: ArmDescription,
        token: Option<Token>,
        program_token: Option<Token>,
        sessions: Sessions,
        help: fn(&Error) -> String,
    ) -> Self {
        let history = Mutex::new(History::new(arm.columns.len()));
        let (status, recording, board_tables) = Default::default();
        let (feed, _) = broadcast::channel(CAPACITY);
        let arm = Mutex::new(arm);
        Self {
            link,
            clock: HostClock::new(),
            arm,
            token,
            program_token,
            sessions,
            help,
            feed,
            history,
            status,
            recording,
            board_tables,
        }
    }

    pub fn arm(&self) -> MutexGuard<'_, ArmDescription> {
        lock(&self.arm)
    }

    /// Sets the size of the board's arm; returns true where it has changed. The rows of an arm with other segments are dropped.
    pub fn set_size(&self, size: ArmSize) -> bool {
        let before = self.arm().size;
        if before == size {
            return false;
        }
        let columns = page_row::names(size).len();
        let mut history = std::mem::replace(&mut *self.history(), History::new(columns));
        // The number of regulators, whose columns are the last, may be known later than the segments.
        if before.segments != size.segments || before.regulators != 0 || !history.widen(columns) {
            history = History::new(columns);
        }
        self.replace(size, history);
        true
    }

    /// Replaces the rows, and describes the arm to every page again.
    pub fn replace(&self, size: ArmSize, history: History) {
        let mut arm = self.arm();
        let table = self.sessions.table().filter(|table| table.file.segments.len() == size.segments);
        *arm = arm.with(size, table.as_ref().map(|table| &table.file));
        *self.history() = history;
        self.publish(&Feed::Arm(&arm));
    }

    /// Takes a board's table.
    pub fn set_board_table(&self, table: Option<OwnedTable>) {
        self.sessions.set_board_table(table);
        self.board_tables.fetch_add(1, Ordering::Relaxed);
    }

    pub fn board_tables(&self) -> u32 {
        self.board_tables.load(Ordering::Relaxed)
    }

    pub fn history(&self) -> MutexGuard<'_, History> {
        lock(&self.history)
    }

    /// Sends a message to every page, if there is any.
    pub fn publish(&self, message: &Feed) {
        let json = Utf8Bytes::from(message.json());
        let published = match message {
            Feed::Rows(batch) => Published::Rows(json, batch.sent_us),
            Feed::Arm(_) => Published::Arm(json),
            // It is about one page, which gets it from its own socket.
            Feed::Delivery(_) => return,
            Feed::Status(_) => {
                lock(&self.status).clone_from(&json);
                Published::Status(json)
            }
        };
        let _ = self.feed.send(published);
    }

    /// The last status that was sent; empty before the first.
    pub fn status(&self) -> Utf8Bytes {
        lock(&self.status).clone()
    }

    pub fn recording(&self) -> Option<RecordingProgress> {
        lock(&self.recording).as_ref().map(Recording::progress)
    }

    /// Begins a recording, unless one is running that has not failed.
    pub fn begin_recording(&self) -> Result<(), Error> {
        let Some(link) = &self.link else { return Ok(()) };
        let mut recording = lock(&self.recording);
        if recording.as_ref().is_none_or(|recording| recording.progress().failed.is_some()) {
            let table = self.sessions.table_toml()?;
            *recording = Some(Recording::begin(link, &self.sessions.folder, table.as_deref(), self.clock)?);
        }
        Ok(())
    }

    /// Completes the running recording, if there is one.
    pub fn finish_recording(&self) -> Result<Option<RecordingProgress>, Error> {
        let recording = lock(&self.recording).take();
        recording.map(Recording::finish).transpose()
    }

    /// Sets a mark in the running recording; returns false without a recording.
    pub fn mark(&self, text: String) -> bool {
        let recording = lock(&self.recording);
        let recording = recording.as_ref();
        recording.inspect(|recording| recording.mark(self.clock.now(), text)).is_some()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
