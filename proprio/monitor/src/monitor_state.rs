//! State that the threads of the monitor share.

use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use proprio_link::Link;
use proprio_session::HostClock;
use tokio::sync::broadcast;

use super::access::Token;
use super::feed::{ArmDescription, Feed};
use super::history::History;
use super::latency::Latency;
use super::recording::{Recording, RecordingProgress};
use super::sessions::Sessions;
use crate::error::Error;

/// Capacity of a browser's queue, messages: one second. A slower browser loses the oldest.
const CAPACITY: usize = 64;

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
    pub feed: broadcast::Sender<Utf8Bytes>,
    history: Mutex<History>,
    status: Mutex<Utf8Bytes>,
    latency: Mutex<Latency>,
    recording: Mutex<Option<Recording>>,
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
        let (status, latency, recording) = Default::default();
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
            latency,
            recording,
        }
    }

    pub fn arm(&self) -> MutexGuard<'_, ArmDescription> {
        lock(&self.arm)
    }

    /// Sets the number of segments of the board's arm; returns true where it has changed. The rows before that are dropped.
    pub fn set_segments(&self, segments: usize) -> bool {
        let mut arm = self.arm();
        if arm.segments == segments {
            return false;
        }
        *arm = arm.with_segments(segments, self.sessions.arm(segments));
        *self.history() = History::new(arm.columns.len());
        self.publish(&Feed::Arm(&arm));
        true
    }

    pub fn history(&self) -> MutexGuard<'_, History> {
        lock(&self.history)
    }

    pub fn latency(&self) -> MutexGuard<'_, Latency> {
        lock(&self.latency)
    }

    /// Sends a message to every page, if there is any.
    pub fn publish(&self, message: &Feed) {
        let json = Utf8Bytes::from(message.json());
        if matches!(message, Feed::Status(_)) {
            *lock(&self.status) = json.clone();
        }
        let _ = self.feed.send(json);
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
