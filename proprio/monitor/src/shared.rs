//! What the threads of the monitor share.

use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::extract::ws::Utf8Bytes;
use proprio_link::Link;
use proprio_session::HostClock;
use tokio::sync::broadcast;

use super::access::Token;
use super::feed::{Arm, Feed};
use super::history::History;
use super::latency::Latency;
use super::recording::{Progress, Recording};
use super::sessions::Sessions;
use crate::error::Error;

/// Messages that wait for a browser: a second of them. One that is slower loses the oldest.
const ROOM: usize = 64;

/// What the threads of the monitor share.
#[derive(Debug)]
pub(super) struct Shared {
    pub link: Option<Link>,
    pub clock: HostClock,
    pub arm: Arm,
    pub token: Option<Token>,
    pub sessions: Sessions,
    pub help: fn(&Error) -> String,
    pub feed: broadcast::Sender<Utf8Bytes>,
    history: Mutex<History>,
    status: Mutex<Utf8Bytes>,
    latency: Mutex<Latency>,
    recording: Mutex<Option<Recording>>,
}

impl Shared {
    pub fn new(
        link: Option<Link>,
        arm: Arm,
        token: Option<Token>,
        sessions: Sessions,
        help: fn(&Error) -> String,
    ) -> Self {
        let history = Mutex::new(History::new(arm.columns.len()));
        let (status, latency, recording) = Default::default();
        let (feed, _) = broadcast::channel(ROOM);
        Self { link, clock: HostClock::new(), arm, token, sessions, help, feed, history, status, latency, recording }
    }

    pub fn history(&self) -> MutexGuard<'_, History> {
        lock(&self.history)
    }

    pub fn latency(&self) -> MutexGuard<'_, Latency> {
        lock(&self.latency)
    }

    /// Sends a message to every page. That there may be none is no matter.
    pub fn tell(&self, message: &Feed) {
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

    pub fn recording(&self) -> Option<Progress> {
        lock(&self.recording).as_ref().map(Recording::progress)
    }

    /// Begins a recording, where none is under way; one that has failed is not.
    pub fn begin_recording(&self) -> Result<(), Error> {
        let Some(link) = &self.link else { return Ok(()) };
        let mut recording = lock(&self.recording);
        if recording.as_ref().is_none_or(|recording| recording.progress().failed.is_some()) {
            let table = self.sessions.table_toml()?;
            *recording = Some(Recording::begin(link, &self.sessions.folder, table.as_deref(), self.clock)?);
        }
        Ok(())
    }

    /// Completes the recording that is under way, if there is one.
    pub fn finish_recording(&self) -> Result<Option<Progress>, Error> {
        let recording = lock(&self.recording).take();
        Ok(recording.map(Recording::finish).transpose()?)
    }

    /// Marks this moment in the recording that is under way; false: there is none.
    pub fn mark(&self, text: String) -> bool {
        let recording = lock(&self.recording);
        let recording = recording.as_ref();
        recording.inspect(|recording| recording.mark(self.clock.now(), text)).is_some()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
