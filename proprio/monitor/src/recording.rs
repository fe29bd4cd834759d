//! A recording that was started from the page: a thread with its own queue, so that no browser slows it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use proprio_link::{FileRecorder, Link, Subscription};
use proprio_session::{Error, HostClock, HostNs};
use serde::Serialize;

/// Longest time between two checks for marks.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// Progress of a recording.
#[derive(Debug, Clone, Serialize)]
pub(super) struct RecordingProgress {
    pub file: String,
    pub samples: u64,
    pub marks: u64,
    /// Events that were dropped because this machine was too slow.
    pub dropped_events: u64,
    /// Reason of its failure; `None` while it has not failed.
    pub failed: Option<String>,
}

/// A running recording.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    marks: Sender<MarkRequest>,
    counts: Arc<Counts>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

/// A mark that a person has set.
#[derive(Debug)]
struct MarkRequest {
    at: HostNs,
    text: String,
}

#[derive(Debug, Default)]
struct Counts {
    samples: AtomicU64,
    marks: AtomicU64,
    dropped: AtomicU64,
    failed: Mutex<Option<String>>,
}

impl Recording {
    /// Begins a recording in a new file of `folder` that is named by the time.
    pub fn begin(link: &Link, folder: &Path, table: Option<&[u8]>, clock: HostClock) -> Result<Self, Error> {
        let path = folder.join(format!("{}.mcap", name(clock.now())));
        let recorder = FileRecorder::create(&path, link, clock, table)?;
        let (marks, received) = channel();
        let counts = Arc::new(Counts::default());
        let work = Work { recorder, events: link.subscribe(), marks: received, counts: Arc::clone(&counts) };
        let thread = std::thread::Builder::new().name("recording".to_owned()).spawn(move || work.run());
        let thread = thread.map_err(|source| Error::Output { path: path.clone(), source })?;
        Ok(Self { marks, counts, thread: Some(thread), path })
    }

    /// Sets a mark.
    pub fn mark(&self, at: HostNs, text: String) {
        // A recording that has failed takes no marks; its progress has the failure.
        let _ = self.marks.send(MarkRequest { at, text });
    }

    pub fn progress(&self) -> RecordingProgress {
        let Counts { samples, marks, dropped, failed } = self.counts.as_ref();
        RecordingProgress {
            file: self.path.display().to_string(),
            samples: samples.load(Ordering::Relaxed),
            marks: marks.load(Ordering::Relaxed),
            dropped_events: dropped.load(Ordering::Relaxed),
            failed: failed.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        }
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<RecordingProgress, Error> {
        let progress = self.progress();
        let (marks, _) = channel();
        // The thread ends when the sender of its marks is dropped.
        drop(std::mem::replace(&mut self.marks, marks));
        let done = self.thread.take().map(JoinHandle::join);
        match done {
            Some(Ok(Err(error))) => Err(error),
            _ => Ok(progress),
        }
    }
}

/// State of the thread.
struct Work {
    recorder: FileRecorder,
    events: Subscription,
    marks: Receiver<MarkRequest>,
    counts: Arc<Counts>,
}

impl Work {
    fn run(mut self) -> Result<(), Error> {
        let done = self.work();
        if let Err(error) = &done {
            // The page shows the file's name with the reason.
            let reason = match error {
                Error::Output { source, .. } => source.to_string(),
                other => other.to_string(),
            };
            *self.counts.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
        }
        done.and_then(|()| self.recorder.finish())
    }

    fn work(&mut self) -> Result<(), Error> {
        loop {
            match self.events.next(CHECK_PERIOD) {
                Some(event) => self.recorder.event(&event)?,
                None => self.recorder.flush_if_due()?,
            }
            self.counts.samples.store(self.recorder.samples(), Ordering::Relaxed);
            self.counts.dropped.store(self.events.dropped(), Ordering::Relaxed);
            match self.marks.try_recv() {
                Ok(MarkRequest { at, text }) => {
                    self.recorder.mark(at, &text)?;
                    self.counts.marks.fetch_add(1, Ordering::Relaxed);
                }
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => return self.recorder.remaining_events(&self.events),
            }
        }
    }
}

/// `session-2026-11-25T10-57-00Z`: the date and time, UTC.
fn name(at: HostNs) -> String {
    let seconds = at.0 / 1_000_000_000;
    let (days, of_day) = (seconds / 86_400, seconds % 86_400);
    // Days since 0000-03-01, in eras of 400 years (H. Hinnant, chrono-compatible low-level date algorithms).
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (year, month) = (era * 400 + year_of_era + month / 10, (month + 2) % 12 + 1);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("session-{year:04}-{month:02}-{day:02}T{hour:02}-{minute:02}-{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::{HostNs, name};

    #[test]
    fn a_recording_is_named_by_the_date_and_time() {
        let name = |seconds: u64| name(HostNs(seconds * 1_000_000_000));
        assert_eq!(name(0), "session-1970-01-01T00-00-00Z");
        // 29 February 2024, and the end of that year.
        assert_eq!(name(1_709_210_096), "session-2024-02-29T12-34-56Z");
        assert_eq!(name(1_735_689_599), "session-2024-12-31T23-59-59Z");
    }
}
