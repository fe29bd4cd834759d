//! The messages of a board.

use std::time::{Duration, Instant};

use proprio::{Board, ShutdownGuard, warn};
use proprio_foxglove::LiveMessages;
use proprio_link::{EventKind, LinkError};

use crate::error::Error;
use crate::node::Node;

/// Longest time between two checks for Ctrl-C.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// Time without a message after which a board is reported as silent.
const SILENCE: Duration = Duration::from_secs(10);

/// Publishes the messages of a board until Ctrl-C, or until its line is gone for good.
pub fn publish(board: &Board, node: &mut Node, shutdown: &ShutdownGuard) -> Result<(), Error> {
    let mut messages = LiveMessages::new(board.table.as_ref());
    let (mut last, mut is_reported) = (Instant::now(), false);
    while !shutdown.is_requested() {
        let Some(event) = board.events.next(CHECK_PERIOD) else {
            if !is_reported && last.elapsed() >= SILENCE {
                warn(&board.link.silent(SILENCE));
                is_reported = true;
            }
            continue;
        };
        messages.take(&event, node)?;
        match event.kind {
            EventKind::Ended(reason) => return Err(LinkError::Ended(reason).into()),
            EventKind::Message(_) => (last, is_reported) = (Instant::now(), false),
            kind => {
                // A line that is lost is reported here, and waited for.
                is_reported |= matches!(kind, EventKind::Lost(_));
                kind.warning().iter().for_each(warn);
            }
        }
    }
    Ok(())
}
