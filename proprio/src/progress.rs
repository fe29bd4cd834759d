//! A bar on stderr for work that takes over a second, on a terminal only.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Work is shown once it has taken this long.
const PATIENCE: Duration = Duration::from_secs(1);

/// Only one in so many calls looks at the clock, so that every row may call.
const CALLS: u64 = 1024;

/// Progress of one piece of work.
pub struct Progress {
    bar: ProgressBar,
    hidden_since: Option<Instant>,
    what: String,
    calls: u64,
}

impl Progress {
    /// Work that is called `what` and has `total` parts.
    #[must_use]
    pub fn new(what: String, total: u64) -> Self {
        let bar = ProgressBar::hidden();
        bar.set_length(total);
        Self { bar, hidden_since: Some(Instant::now()), what, calls: 0 }
    }

    /// `done` parts are done.
    pub fn set(&mut self, done: u64) {
        self.calls += 1;
        if !self.calls.is_multiple_of(CALLS) {
            return;
        }
        if self.hidden_since.is_some_and(|since| since.elapsed() > PATIENCE) {
            self.hidden_since = None;
            self.show();
        }
        self.bar.set_position(done);
    }

    /// `done` parts are done, each of which takes long, and the work is called `what` from here on.
    pub fn tell(&mut self, done: u64, what: String) {
        self.what = what;
        self.calls = CALLS - 1;
        self.set(done);
        self.bar.set_message(self.what.clone());
    }

    fn show(&self) {
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent} % {eta} left");
        self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        self.bar.set_message(self.what.clone());
        self.bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
