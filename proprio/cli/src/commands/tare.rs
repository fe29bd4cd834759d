//! `proprio tare`.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, Subscription, tare};
use telemetry::{Message, TareMode};

use super::link;
use crate::args::TareArgs;
use crate::error::Error;
use crate::terminal;

/// Tick of the board from which on its IMUs run, and half a second of their headings is known.
const SETTLED_TICK: u32 = 300;
/// Longest wait for it; a board whose samples are turned off is tared then.
const SETTLED_WITHIN: Duration = Duration::from_secs(6);

pub fn run(args: &TareArgs) -> Result<(), Error> {
    let mode = if args.force { TareMode::Force } else { TareMode::IfStill };
    if let Some(monitor) = link::monitor(&args.link) {
        return terminal::print(&format!("{}\n", monitor.tare(mode)?));
    }
    let (_, link, events) = link::open(&args.link)?;
    terminal::eprint_line(&"waiting up to 3 s: opening the port restarts a board, and its IMUs start");
    wait_until_settled(&events);
    let tared = tare(&link, mode)?;
    terminal::print(&format!("{tared}\n"))
}

/// Waits until the board has run for some seconds: opening its port has restarted it.
fn wait_until_settled(events: &Subscription) {
    let end = Instant::now() + SETTLED_WITHIN;
    while let Some(event) = events.next(end.saturating_duration_since(Instant::now())) {
        if matches!(event.kind, EventKind::Message(Message::Sample(sample)) if sample.tick >= SETTLED_TICK) {
            return;
        }
    }
}
