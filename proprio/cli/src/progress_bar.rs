//! Progress of long work: a bar on standard error, on a terminal only, for work that takes over a second.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use proprio_session::Progress;

/// Delay before the bar is shown.
const DELAY: Duration = Duration::from_secs(1);

/// Calls of [`Progress::advance`] for one reading of the clock.
const CALLS: u64 = 1024;

/// A bar for consecutive pieces of work.
pub struct Bar {
    shown: ProgressBar,
    work: String,
    hidden_since: Option<Instant>,
    calls: u64,
}

impl Bar {
    /// A bar that is hidden.
    pub fn new() -> Self {
        Self { shown: ProgressBar::hidden(), work: String::new(), hidden_since: Some(Instant::now()), calls: 0 }
    }

    fn set(&mut self, work: &str, (done, total): (u64, u64)) {
        if self.hidden_since.is_some_and(|since| since.elapsed() > DELAY) {
            self.hidden_since = None;
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent} % {eta} left");
            self.shown.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.shown.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.shown.set_length(total);
        self.shown.set_message(work.to_owned());
        self.shown.set_position(done);
    }
}

impl Progress for Bar {
    fn advance(&mut self, work: &str, done_of_all: (u64, u64)) {
        self.calls += 1;
        if work != self.work {
            // The next piece of work has a delay and an estimate of its own.
            work.clone_into(&mut self.work);
            self.shown.finish_and_clear();
            (self.shown, self.hidden_since, self.calls) = (ProgressBar::hidden(), Some(Instant::now()), 0);
        } else if self.calls.is_multiple_of(CALLS) {
            self.set(work, done_of_all);
        }
    }

    fn complete(&mut self, work: &str, done_of_all: (u64, u64)) {
        self.set(work, done_of_all);
    }
}

/// A bar for pieces of work that run at the same time.
pub struct JoinedBar {
    bar: Bar,
    work: String,
    /// Parts of each that are done, and all.
    pieces: Vec<(u64, u64)>,
}

impl JoinedBar {
    /// A bar that is hidden, for `work` on so many pieces.
    pub fn new(work: &str, pieces: usize) -> Self {
        Self { bar: Bar::new(), work: format!("{work} {pieces} sessions"), pieces: vec![(0, 1); pieces] }
    }

    /// The progress of one piece.
    pub fn part(bar: &Mutex<Self>, piece: usize) -> impl Progress {
        Part { bar, piece, calls: 0 }
    }

    /// Runs `print`, whose lines the bar does not disturb.
    pub fn hidden(&self, print: impl FnOnce()) {
        self.bar.shown.suspend(print);
    }

    fn set(&mut self, piece: usize, (done, total): (u64, u64)) {
        self.pieces[piece] = (done.min(total), total.max(1));
        let share = |(done, total): &(u64, u64)| done * PIECE / total;
        let done = self.pieces.iter().map(share).sum();
        self.bar.set(&self.work, (done, PIECE * self.pieces.len() as u64));
    }
}

/// Parts of a piece of joined work.
const PIECE: u64 = 1000;

/// One piece of joined work.
struct Part<'b> {
    bar: &'b Mutex<JoinedBar>,
    piece: usize,
    calls: u64,
}

impl Progress for Part<'_> {
    fn advance(&mut self, work: &str, done_of_all: (u64, u64)) {
        self.calls += 1;
        if self.calls.is_multiple_of(CALLS) {
            self.complete(work, done_of_all);
        }
    }

    fn complete(&mut self, _: &str, done_of_all: (u64, u64)) {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner).set(self.piece, done_of_all);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.shown.finish_and_clear();
    }
}
