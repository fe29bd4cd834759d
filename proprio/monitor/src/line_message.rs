//! Messages between a monitor and a program that uses its line: JSON, and received bytes in a binary form.

use std::sync::Arc;

use proprio_link::{ReceivedBytes, RequestError};
use proprio_session::HostNs;
use serde::{Deserialize, Serialize};
use telemetry::{Command, SetPressures};

/// Message of the monitor, as JSON.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LineMessage {
    /// Begin: the name of the line where it is open, and whether the bytes since the last start of the board's estimator follow.
    Begin { line: Option<String>, has_history: bool },
    /// End of those bytes: what follows is live.
    Live,
    /// The line was opened again.
    Opened(String),
    /// The line was lost, for this reason.
    Lost(String),
    /// The line is gone for good, for this reason.
    Ended(String),
    /// Any program has requested pressures.
    SetPoints { at_ns: u64, requested: SetPressures },
    /// Number of events that were dropped because the program is too slow.
    Dropped(u64),
    /// Outcome of the program's request with this id; no error where it was done.
    Answer { id: u32, error: Option<RequestError> },
}

/// Request of the program to the board, as JSON.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct LineRequest {
    /// Number of the request for its answer.
    pub id: u32,
    pub command: Command,
}

/// Bytes of the time and the length in front of received bytes.
const HEAD: usize = 12;

/// Adds received bytes to a binary message: their time, ns since 1970, as u64, their number as u32, both little-endian, and they.
pub(super) fn push_bytes(message: &mut Vec<u8>, (at, bytes): &ReceivedBytes) {
    message.extend(at.0.to_le_bytes());
    message.extend((bytes.len() as u32).to_le_bytes());
    message.extend(&bytes[..]);
}

/// The received bytes in a binary message; `None` where it has another form.
pub(super) fn split_bytes(mut message: &[u8]) -> Option<Vec<ReceivedBytes>> {
    let mut received = Vec::new();
    while !message.is_empty() {
        let (head, rest) = message.split_at_checked(HEAD)?;
        let (at, length) = head.split_at(8);
        let length = u32::from_le_bytes(length.try_into().ok()?);
        let (bytes, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
        received.push((HostNs(u64::from_le_bytes(at.try_into().ok()?)), Arc::from(bytes)));
        message = rest;
    }
    Some(received)
}

#[cfg(test)]
mod tests {
    use super::{Arc, HostNs, ReceivedBytes, push_bytes, split_bytes};

    #[test]
    fn received_bytes_keep_their_times_and_limits() {
        let received: [ReceivedBytes; 3] =
            [(1, &[0, 7][..]), (u64::MAX, &[]), (2, &[1; 300])].map(|(at, bytes)| (HostNs(at), Arc::from(bytes)));
        let mut message = Vec::new();
        for one in &received {
            push_bytes(&mut message, one);
        }
        assert_eq!(split_bytes(&message), Some(received.to_vec()));
        for length in [1, 11, message.len() - 1] {
            assert_eq!(split_bytes(&message[..length]), None, "cut at {length}");
        }
    }
}
