//! A recording that the page has asked for: a thread and a queue of its own, so that no browser slows it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use proprio_link::{FileRecorder, Link, Subscription};
use proprio_session::{Error, HostClock, HostNs};
use serde::Serialize;

/// Longest time from one look at what is asked to the next.
const LOOK: Duration = Duration::from_millis(50);

/// How far a recording is.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Progress {
    pub file: String,
    pub samples: u64,
    pub marks: u64,
    /// What this machine was too slow to write.
    pub dropped_events: u64,
    /// Why it has ended, where nobody asked it to.
    pub failed: Option<String>,
}

/// A recording under way.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    asks: Sender<Mark>,
    shared: Arc<Counts>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

/// Something happened, says the user.
#[derive(Debug)]
struct Mark {
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
    /// Begins one, in a new file of `folder` that is named by the time.
    pub fn begin(link: &Link, folder: &Path, table: Option<&[u8]>, clock: HostClock) -> Result<Self, Error> {
        let path = folder.join(format!("{}.mcap", name(clock.now())));
        let recorder = FileRecorder::create(&path, link, clock, table)?;
        let (asks, asked) = channel();
        let shared = Arc::new(Counts::default());
        let work = Work { recorder, events: link.subscribe(), asked, shared: Arc::clone(&shared) };
        let thread = std::thread::Builder::new().name("recording".to_owned()).spawn(move || work.run());
        let thread = thread.map_err(|source| Error::Output { path: path.clone(), source })?;
        Ok(Self { asks, shared, thread: Some(thread), path })
    }

    /// Marks this moment.
    pub fn mark(&self, at: HostNs, text: String) {
        // Where it has failed there is nothing to be marked, and its progress says so.
        let _ = self.asks.send(Mark { at, text });
    }

    pub fn progress(&self) -> Progress {
        let Counts { samples, marks, dropped, failed } = self.shared.as_ref();
        Progress {
            file: self.path.display().to_string(),
            samples: samples.load(Ordering::Relaxed),
            marks: marks.load(Ordering::Relaxed),
            dropped_events: dropped.load(Ordering::Relaxed),
            failed: failed.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        }
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<Progress, Error> {
        let progress = self.progress();
        let (asks, _) = channel();
        // With nobody to ask any more the thread comes to its end.
        drop(std::mem::replace(&mut self.asks, asks));
        let done = self.thread.take().map(JoinHandle::join);
        match done {
            Some(Ok(Err(error))) => Err(error),
            _ => Ok(progress),
        }
    }
}

/// What the thread owns.
struct Work {
    recorder: FileRecorder,
    events: Subscription,
    asked: Receiver<Mark>,
    shared: Arc<Counts>,
}

impl Work {
    fn run(mut self) -> Result<(), Error> {
        let done = self.work();
        if let Err(error) = &done {
            // The page shows the file's name beside the reason.
            let reason = match error {
                Error::Output { source, .. } => source.to_string(),
                other => other.to_string(),
            };
            *self.shared.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
        }
        done.and_then(|()| self.recorder.finish())
    }

    fn work(&mut self) -> Result<(), Error> {
        loop {
            match self.events.next(LOOK) {
                Some(event) => self.recorder.event(&event)?,
                None => self.recorder.flush_if_due()?,
            }
            self.shared.samples.store(self.recorder.samples(), Ordering::Relaxed);
            self.shared.dropped.store(self.events.dropped(), Ordering::Relaxed);
            match self.asked.try_recv() {
                Ok(Mark { at, text }) => {
                    self.recorder.mark(at, &text)?;
                    self.shared.marks.fetch_add(1, Ordering::Relaxed);
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
