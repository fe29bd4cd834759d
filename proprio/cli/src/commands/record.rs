//! `proprio record`.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, FileRecorder, Link, LinkError, LinkEvent, ReceivedBytes, Subscription, decoded};
use proprio_session::{RowAssembler, check_seconds};
use telemetry::Counts;

use super::link::{self, Board};
use crate::args::RecordArgs;
use crate::error::Error;
use crate::interrupt::ShutdownGuard;
use crate::status_line::{StatusLine, time};
use crate::terminal;

/// Period of the status line.
const STATUS_PERIOD: Duration = Duration::from_millis(500);

pub fn run(args: &RecordArgs) -> Result<(), Error> {
    args.seconds.map_or(Ok(()), check_seconds)?;
    let board = link::open_shared(&args.link, true)?;
    let shutdown = ShutdownGuard::new();
    let _stream = link::stream(&args.foxglove, &board.link, board.table.as_ref())?;
    let mut session = Session::new(link::recorder(&args.output, &board)?);
    session.follow_history(board.history.as_deref().unwrap_or_default());
    let Board { link, events, .. } = board;
    let end = args.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
    while session.ended.is_none() && !shutdown.is_requested() && end.is_none_or(|end| Instant::now() < end) {
        session.step(&link, &events)?;
    }
    session.finish(link, &events)
}

/// A running recording, and its status line.
struct Session {
    recorder: FileRecorder,
    screen: StatusLine,
    start: Instant,
    shown: Instant,
    samples_shown: u64,
    assembler: RowAssembler,
    /// Samples that a replay cannot compare: the line was opened after the board's tare, or samples were lost.
    not_comparable: u64,
    /// Reason of the end of a line that is gone for good.
    ended: Option<String>,
}

impl Session {
    fn new(recorder: FileRecorder) -> Self {
        let now = Instant::now();
        Self {
            recorder,
            screen: StatusLine::new(),
            start: now,
            shown: now,
            samples_shown: 0,
            assembler: RowAssembler::default(),
            not_comparable: 0,
            ended: None,
        }
    }

    /// Takes one event, or waits up to 50 ms for one.
    fn step(&mut self, link: &Link, events: &Subscription) -> Result<(), Error> {
        match events.next(Duration::from_millis(50)) {
            Some(event) => {
                self.recorder.event(&event)?;
                self.follow(&event);
                match event.kind {
                    EventKind::Ended(reason) => self.ended = Some(reason),
                    kind => self.screen.warn_of(&kind),
                }
            }
            None => self.recorder.flush_if_due()?,
        }
        let since = self.shown.elapsed();
        if since >= STATUS_PERIOD {
            let rate_hz = (self.recorder.samples() - self.samples_shown) as f64 / since.as_secs_f64();
            (self.shown, self.samples_shown) = (Instant::now(), self.recorder.samples());
            self.screen.show(self.line(link.state().counts, events, rate_hz));
        }
        Ok(())
    }

    /// Follows the starts of the board's estimator before the recording.
    fn follow_history(&mut self, history: &[ReceivedBytes]) {
        decoded(history, |event| self.follow(event));
        self.not_comparable = 0;
    }

    /// Follows the starts of the board's estimator.
    fn follow(&mut self, event: &LinkEvent) {
        match &event.kind {
            EventKind::Opened(_) => self.assembler.line_opened(),
            EventKind::Message(message) => {
                // A `Hello` with another schema is a mismatch, of which the link has an event.
                let _ = self.assembler.message(event.at, message, event.gaps);
                let Some(board) = self.assembler.take_last().and_then(|row| row.board) else { return };
                // Samples before a boot are what was left on the line.
                self.not_comparable =
                    if board.tick == 0 { 0 } else { self.not_comparable + u64::from(!board.complete) };
            }
            _ => {}
        }
    }

    /// Summary of the recording so far.
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

    /// Takes the events that have come, and completes the file.
    fn finish(mut self, link: Link, events: &Subscription) -> Result<(), Error> {
        let counts = link.state().counts;
        let silent = link.silent(self.start.elapsed());
        // No more events come.
        drop(link);
        self.recorder.remaining_events(events)?;
        if self.ended.is_none() && self.recorder.samples() == 0 && counts == Counts::default() {
            self.recorder.discard()?;
            return Err(silent.into());
        }
        let rate_hz = self.recorder.samples() as f64 / self.start.elapsed().as_secs_f64();
        let line = self.line(counts, events, rate_hz);
        let path = self.recorder.path().to_owned();
        self.recorder.finish()?;
        self.screen.end(&format_args!("{}: {line}", path.display()));
        if self.not_comparable > 0 {
            let count = self.not_comparable;
            terminal::warn(&format_args!(
                "{}: {count} samples are before a tare of the board that is recorded, or behind a lost sample: a replay cannot \
                 compare them; opening the line did not restart the board, or the line was disturbed",
                path.display()
            ));
        }
        self.ended.map_or(Ok(()), |reason| Err(LinkError::Ended(reason).into()))
    }
}
