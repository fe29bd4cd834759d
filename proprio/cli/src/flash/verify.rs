//! Verifies the flashed firmware by the `Hello` that the board sends.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, Link, LinkError, Subscription};
use telemetry::{Hello, Message};

use super::FlashError;

/// Longest silence of a board, s: it sends `Hello` each second.
const TIMEOUT_S: u64 = 10;

/// Waits for the `Hello` of the board, on a link that compares its table with none.
///
/// # Errors
/// [`FlashError::Silent`], [`FlashError::Unheard`], and [`FlashError::Other`] where version or messages are not those of this
/// release.
pub fn verify(link: &Link, events: &Subscription) -> Result<Hello, FlashError> {
    let start = Instant::now();
    while start.elapsed().as_secs() < TIMEOUT_S {
        match events.next(Duration::from_millis(50)).map(|event| event.kind) {
            // This event comes before the `Hello` that shows the mismatch.
            Some(EventKind::Mismatch(mismatch)) => return Err(FlashError::Other(mismatch)),
            Some(EventKind::Message(Message::Hello(hello))) => return Ok(hello),
            Some(EventKind::Ended(reason)) => return Err(FlashError::Unheard(LinkError::Ended(reason))),
            _ => {}
        }
    }
    let port = link.state().port.unwrap_or_else(|| "the line".to_owned());
    Err(FlashError::Silent { port, seconds: TIMEOUT_S })
}
