//! A recording that was started from the page: a thread with its own queue, so that no browser slows it.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use proprio_link::{FileRecorder, Link, ReceivedBytes, Subscription};
use proprio_session::{HostClock, HostNs};
use serde::Serialize;

use crate::error::Error;

/// Longest time between two checks for marks.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// Progress of a recording.
#[derive(Debug, Clone, Serialize)]
pub(super) struct RecordingProgress {
    pub file: String,
    /// A replay of it begins with the state of the board's estimator; otherwise it has another until the next tare.
    pub is_comparable: bool,
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
    is_comparable: bool,
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
        let (events, history) = link.subscribe_with_history();
        let counts = Counts { is_comparable: history.is_some(), ..Counts::default() };
        Self::start(path, counts, move |marks, counts| Work { recorder, events, marks, counts }.run(history))
    }

    /// Starts the thread, which does `work`.
    fn start(
        path: PathBuf,
        counts: Counts,
        work: impl FnOnce(Receiver<MarkRequest>, Arc<Counts>) -> Result<(), Error> + Send + 'static,
    ) -> Result<Self, Error> {
        let (marks, received) = channel();
        let counts = Arc::new(counts);
        let shared = Arc::clone(&counts);
        let run = move || {
            let done = catch_unwind(AssertUnwindSafe(|| work(received, Arc::clone(&shared))));
            done.unwrap_or_else(|panic| {
                shared.fail("this is a fault of proprio".to_owned());
                resume_unwind(panic)
            })
        };
        let thread = std::thread::Builder::new().name("recording".to_owned()).spawn(run);
        let thread = thread.map_err(|source| proprio_session::Error::Output { path: path.clone(), source })?;
        Ok(Self { marks, counts, thread: Some(thread), path })
    }

    /// Sets a mark.
    pub fn mark(&self, at: HostNs, text: String) {
        // A recording that has failed takes no marks; its progress has the failure.
        let _ = self.marks.send(MarkRequest { at, text });
    }

    pub fn progress(&self) -> RecordingProgress {
        let Counts { is_comparable, samples, marks, dropped, failed } = self.counts.as_ref();
        RecordingProgress {
            file: self.path.display().to_string(),
            is_comparable: *is_comparable,
            samples: samples.load(Ordering::Relaxed),
            marks: marks.load(Ordering::Relaxed),
            dropped_events: dropped.load(Ordering::Relaxed),
            failed: failed.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        }
    }

    /// Completes the file, and returns the progress at its end.
    pub fn finish(mut self) -> Result<RecordingProgress, Error> {
        let (marks, _) = channel();
        // The thread ends when the sender of its marks is dropped.
        drop(std::mem::replace(&mut self.marks, marks));
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(_)) => Err(Error::RecorderPanicked(self.path)),
            Some(Ok(Err(error))) => Err(error),
            Some(Ok(Ok(()))) | None => Ok(self.progress()),
        }
    }
}

impl Counts {
    /// Sets the reason of a failure.
    fn fail(&self, reason: String) {
        *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
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
    fn run(mut self, history: Option<Vec<ReceivedBytes>>) -> Result<(), Error> {
        let done = self.work(&history.unwrap_or_default());
        if let Err(error) = &done {
            // The page shows the file's name with the reason.
            self.counts.fail(match error {
                Error::File(proprio_session::Error::Output { source, .. }) => source.to_string(),
                other => other.to_string(),
            });
        }
        done.and_then(|()| Ok(self.recorder.finish()?))
    }

    fn work(&mut self, history: &[ReceivedBytes]) -> Result<(), Error> {
        self.recorder.history(history)?;
        loop {
            match self.events.next(CHECK_PERIOD) {
                Some(event) => self.recorder.event(&event)?,
                None => self.recorder.flush_if_due()?,
            }
            self.count();
            match self.marks.try_recv() {
                Ok(MarkRequest { at, text }) => {
                    self.recorder.mark(at, &text)?;
                    self.counts.marks.fetch_add(1, Ordering::Relaxed);
                }
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => {
                    self.recorder.remaining_events(&self.events)?;
                    self.count();
                    return Ok(());
                }
            }
        }
    }

    fn count(&self) {
        self.counts.samples.store(self.recorder.samples(), Ordering::Relaxed);
        self.counts.dropped.store(self.events.dropped(), Ordering::Relaxed);
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
    use std::path::PathBuf;
    use std::sync::atomic::Ordering;

    use super::{Counts, HostNs, Recording, name};
    use crate::error::Error;

    #[test]
    fn a_panic_of_the_recorder_is_shown_and_fails_the_recording() {
        let recording = Recording::start(PathBuf::from("a.mcap"), Counts::default(), |marks, _| {
            let _ = marks.recv();
            panic!("a fault, on purpose");
        });
        let recording = recording.expect("a thread starts");
        assert_eq!(recording.progress().failed, None);
        recording.mark(HostNs(0), String::new());
        while recording.progress().failed.is_none() {
            std::thread::yield_now();
        }
        assert_eq!(recording.progress().failed.as_deref(), Some("this is a fault of proprio"));
        let finished = recording.finish();
        assert!(matches!(&finished, Err(Error::RecorderPanicked(path)) if path.ends_with("a.mcap")), "{finished:?}");
    }

    #[test]
    fn the_progress_at_the_end_is_that_of_the_finished_file() {
        let recording = Recording::start(PathBuf::from("a.mcap"), Counts::default(), |marks, counts| {
            // The end of the marks is the end of the recording; events that wait are written after it.
            while marks.recv().is_ok() {}
            counts.samples.store(7, Ordering::Relaxed);
            Ok(())
        });
        assert_eq!(recording.expect("a thread starts").finish().expect("it has no fault").samples, 7);
    }

    #[test]
    fn a_recording_is_named_by_the_date_and_time() {
        let name = |seconds: u64| name(HostNs(seconds * 1_000_000_000));
        assert_eq!(name(0), "session-1970-01-01T00-00-00Z");
        // 29 February 2024, and the end of that year.
        assert_eq!(name(1_709_210_096), "session-2024-02-29T12-34-56Z");
        assert_eq!(name(1_735_689_599), "session-2024-12-31T23-59-59Z");
    }
}
