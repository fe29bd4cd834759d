//! `proprio record`.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, FileRecorder, Link, LinkError, Subscription};
use proprio_session::check_seconds;
use telemetry::Counts;

use super::link;
use crate::args::Record;
use crate::error::Error;
use crate::interrupt::ShutdownGuard;
use crate::status_line::{StatusLine, time};

/// Time from one status line to the next.
const LOOK: Duration = Duration::from_millis(500);

pub fn run(args: &Record) -> Result<(), Error> {
    args.seconds.map_or(Ok(()), check_seconds)?;
    let (table, link, events) = link::open(&args.link)?;
    let shutdown = ShutdownGuard::new();
    let mut session = Session::new(link::recorder(&args.output, &link, table.as_ref())?);
    let end = args.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while session.ended.is_none() && !shutdown.is_requested() && end.is_none_or(|end| Instant::now() < end) {
        session.step(&link, &events)?;
    }
    session.finish(link, &events)
}

/// A recording under way, and what is shown of it.
struct Session {
    recorder: FileRecorder,
    screen: StatusLine,
    start: Instant,
    looked: Instant,
    samples_then: u64,
    /// The line is gone for good, and why.
    ended: Option<String>,
}

impl Session {
    fn new(recorder: FileRecorder) -> Self {
        let now = Instant::now();
        Self { recorder, screen: StatusLine::new(), start: now, looked: now, samples_then: 0, ended: None }
    }

    /// Takes one event, or waits a little for one.
    fn step(&mut self, link: &Link, events: &Subscription) -> Result<(), Error> {
        match events.next(Duration::from_millis(50)) {
            Some(event) => {
                self.recorder.event(&event)?;
                match event.kind {
                    EventKind::Ended(reason) => self.ended = Some(reason),
                    what => self.screen.warn_of(&what),
                }
            }
            None => self.recorder.flush_if_due()?,
        }
        let since = self.looked.elapsed();
        if since >= LOOK {
            let rate_hz = (self.recorder.samples() - self.samples_then) as f64 / since.as_secs_f64();
            (self.looked, self.samples_then) = (Instant::now(), self.recorder.samples());
            self.screen.show(self.line(link.state().counts, events, rate_hz));
        }
        Ok(())
    }

    /// What was recorded so far.
    fn line(&self, counts: Counts, events: &Subscription, rate_hz: f64) -> String {
        let samples = self.recorder.samples();
        let dropped = match events.dropped() {
            0 => String::new(),
            dropped => format!(", {dropped} events not written: this machine or its disk is too slow"),
        };
        format!(
            "{}  {samples} samples  {rate_hz:.1}/s  {} frames lost, {} damaged{dropped}",
            time(self.start.elapsed()),
            counts.lost,
            counts.damaged
        )
    }

    /// Takes what has come until now, and completes the file.
    fn finish(mut self, link: Link, events: &Subscription) -> Result<(), Error> {
        let counts = link.state().counts;
        // Nothing comes any more.
        drop(link);
        self.recorder.remaining_events(events)?;
        let rate_hz = self.recorder.samples() as f64 / self.start.elapsed().as_secs_f64();
        let line = self.line(counts, events, rate_hz);
        let path = self.recorder.path().to_owned();
        self.recorder.finish()?;
        self.screen.end(&format_args!("{}: {line}", path.display()));
        self.ended.map_or(Ok(()), |reason| Err(LinkError::Ended(reason).into()))
    }
}
