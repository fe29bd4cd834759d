//! `proprio record`.

use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use proprio::error::Error;
use proprio::interrupt::Heed;
use proprio::link::{Event, HostClock, HostNs, Link, LinkError, Subscription, What};
use proprio::recording::Recorder;
use proprio::replay::NamedTable;
use telemetry::{Counts, Message};

use super::link;
use crate::cli::Record;

/// Time from one status line to the next.
const LOOK: Duration = Duration::from_millis(500);

pub fn run(args: &Record) -> Result<(), Error> {
    if let Some(seconds) = args.seconds.filter(|seconds| !(*seconds > 0.0 && *seconds <= 1e7)) {
        return Err(Error::Seconds(seconds));
    }
    let (table, link, events) = link::open(&args.link)?;
    let heed = Heed::interrupts();
    let file = create(&args.output)?;
    let mut session = Session::begin(file, &args.output, &link, table.as_ref())?;
    let end = args.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while session.ended.is_none() && !heed.is_requested() && end.is_none_or(|end| Instant::now() < end) {
        session.step(&link, &events)?;
    }
    session.finish(link, &events)
}

/// A file of this name, where there was none: a recording cannot be had again. A pipe or device is written to.
fn create(path: &Path) -> Result<File, Error> {
    let is_other = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let mut options = OpenOptions::new();
    let options = if is_other { options.write(true) } else { options.write(true).create_new(true) };
    options.open(path).map_err(|source| match source.kind() {
        std::io::ErrorKind::AlreadyExists => Error::Exists(path.to_owned()),
        _ => Error::Output { path: path.to_owned(), source },
    })
}

type Output = Recorder<BufWriter<File>>;

/// A recording under way.
struct Session<'p> {
    recorder: Output,
    path: &'p Path,
    clock: HostClock,
    start: Instant,
    samples: u64,
    bar: ProgressBar,
    looked: Instant,
    samples_then: u64,
    /// The line is gone for good, and why.
    ended: Option<String>,
}

impl<'p> Session<'p> {
    fn begin(file: File, path: &'p Path, link: &Link, table: Option<&NamedTable>) -> Result<Self, Error> {
        let clock = HostClock::new();
        let failed = |source| Error::Output { path: path.to_owned(), source };
        let line = link.state().port.unwrap_or_default();
        let mut recorder = Recorder::new(BufWriter::new(file), clock.now(), &line).map_err(failed)?;
        if let Some(table) = table {
            let toml = fs::read(table.path)
                .map_err(|source| Error::Table { path: table.path.to_owned(), source: source.into() })?;
            recorder.attach_table(clock.now(), &toml).map_err(failed)?;
        }
        let bar = if std::io::stderr().is_terminal() { ProgressBar::no_length() } else { ProgressBar::hidden() };
        bar.set_style(ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar()));
        let now = Instant::now();
        Ok(Self { recorder, path, clock, start: now, samples: 0, bar, looked: now, samples_then: 0, ended: None })
    }

    /// Takes one event, or waits a little for one.
    fn step(&mut self, link: &Link, events: &Subscription) -> Result<(), Error> {
        match events.next(Duration::from_millis(50)) {
            Some(event) => self.take(event)?,
            None => self.written(Recorder::flush_if_due)?,
        }
        let since = self.looked.elapsed();
        if since >= LOOK {
            let rate_hz = (self.samples - self.samples_then) as f64 / since.as_secs_f64();
            (self.looked, self.samples_then) = (Instant::now(), self.samples);
            self.bar.set_message(self.line(link.state().counts, events, rate_hz));
        }
        Ok(())
    }

    fn take(&mut self, event: Event) -> Result<(), Error> {
        let Event { at, what } = event;
        match what {
            What::Bytes(bytes) => return self.written(|recorder, _| recorder.bytes(at, &bytes)),
            What::Message(message) => {
                self.samples += u64::from(matches!(message, Message::Sample(_)));
                return self.written(|recorder, _| recorder.message(at, &message));
            }
            What::Ended(reason) => self.ended = Some(reason),
            What::Lost(reason) => self.warn(&format_args!("{reason}; waiting for it to come back")),
            What::Restarted => self.warn(&"the board has restarted"),
            What::Mismatch(mismatch) => self.warn(&mismatch),
            What::Opened(_) | What::Undecoded(_) => {}
        }
        Ok(())
    }

    fn written(&mut self, write: impl FnOnce(&mut Output, HostNs) -> std::io::Result<()>) -> Result<(), Error> {
        let now = self.clock.now();
        write(&mut self.recorder, now).map_err(|source| Error::Output { path: self.path.to_owned(), source })
    }

    fn warn(&self, warning: &impl std::fmt::Display) {
        self.bar.suspend(|| super::warn(warning));
    }

    /// What was recorded so far.
    fn line(&self, counts: Counts, events: &Subscription, rate_hz: f64) -> String {
        let seconds = self.start.elapsed().as_secs();
        let dropped = match events.dropped() {
            0 => String::new(),
            dropped => format!(", {dropped} events not written: this machine or its disk is too slow"),
        };
        format!(
            "{}:{:02}:{:02}  {} samples  {rate_hz:.1}/s  {} frames lost, {} damaged{dropped}",
            seconds / 3600,
            seconds / 60 % 60,
            seconds % 60,
            self.samples,
            counts.lost,
            counts.damaged
        )
    }

    /// Takes what has come until now, and completes the file.
    fn finish(mut self, link: Link, events: &Subscription) -> Result<(), Error> {
        let counts = link.state().counts;
        // Nothing comes any more.
        drop(link);
        while let Some(event) = events.next(Duration::ZERO) {
            self.take(event)?;
        }
        let rate_hz = self.samples as f64 / self.start.elapsed().as_secs_f64();
        let line = self.line(counts, events, rate_hz);
        self.bar.finish_and_clear();
        let failed = |source| Error::Output { path: self.path.to_owned(), source };
        let mut sink = self.recorder.finish().map_err(failed)?;
        sink.flush().map_err(failed)?;
        super::say(&format_args!("{}: {line}", self.path.display()));
        self.ended.map_or(Ok(()), |reason| Err(LinkError::Ended(reason).into()))
    }
}
