//! Transfer of a table to a board and back.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

use board_table::body_crc;
use proprio_session::Progress;
use serde::{Deserialize, Serialize};
use telemetry::{Command, Hello, Message, Refusal, TABLE_CHUNK_BYTES, TableChunk, TableState, TableStatus};

use super::stored::{StoredTable, expand};
use crate::error::LinkError;
use crate::event::EventKind;
use crate::handle::{Link, PendingRequest};
use crate::requests::RequestError;
use crate::shared::Subscription;

/// Longest wait for a message that follows a reply.
const MESSAGE: Duration = Duration::from_secs(2);

/// Longest wait for the `Hello` of a board that restarts with another table.
const RESTART: Duration = Duration::from_secs(5);

/// Pieces that wait in the link's queue.
const PENDING: usize = 4;

/// Number of times that an interrupted transfer is resumed.
const RESUMPTIONS: u32 = 5;

/// Reason why a transfer failed.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// The line, or a refusal of the board.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The board does not send what follows a reply.
    #[error("the board does not send the state of its table")]
    NoState,
    /// The board has no table to send.
    #[error("the board has no table: {0}")]
    NoTable(&'static str),
    /// What arrived has another checksum.
    #[error("the table that arrived is damaged")]
    Damaged,
    /// The source cannot be expanded.
    #[error("the table's source is damaged: {0}")]
    Source(#[from] io::Error),
    /// After the transfer the board has another table.
    #[error("the board restarted with table {found:08x} instead of {expected:08x}")]
    OtherTable {
        /// Checksum of the table that was sent.
        expected: u32,
        /// Checksum of the board's table.
        found: u32,
    },
}

/// A table that was read from a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PulledTable {
    /// Text of the TOML file, as it was written.
    pub toml: String,
    /// Number of the table on the board.
    pub generation: u32,
}

/// The table of a board: its arm, its checksum, and the state of its storage.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableOnBoard {
    /// Name of the arm; empty without a table.
    pub arm: String,
    /// Checksum of the table that is in use; 0: none.
    pub checksum: u32,
    /// State of the storage.
    pub state: TableState,
}

/// Sends a table to a board, which checks it, restarts and uses it; returns the board's `Hello` after that. `progress` is
/// called with the bytes sent. An interrupted transfer is resumed.
///
/// # Errors
/// [`TransferError`]: the board goes on with the table that it had.
pub fn push(link: &Link, table: &StoredTable, progress: &mut dyn Progress) -> Result<Hello, TransferError> {
    link.wait_until_connected()?;
    let events = link.subscribe();
    let body = table.body();
    let mut resumptions = 0;
    loop {
        link.request(table.begin())?;
        let state = next_state(&events)?;
        match send(link, &body, state.received_bytes as usize, progress) {
            Err(LinkError::Request(
                RequestError::Refused(Refusal::TableOrder | Refusal::Late) | RequestError::Interrupted,
            )) if resumptions < RESUMPTIONS => {
                resumptions += 1;
            }
            result => break result?,
        }
    }
    link.request(Command::TableCommit)?;
    let hello = next_hello(&events)?;
    let (expected, found) = (table.checksum, hello.table);
    if found == expected { Ok(hello) } else { Err(TransferError::OtherTable { expected, found }) }
}

/// Sends the body from an offset on.
fn send(link: &Link, body: &[u8], from: usize, progress: &mut dyn Progress) -> Result<(), LinkError> {
    // The link sends pieces ahead of their replies; a few that wait here keep it busy.
    let mut pending = VecDeque::new();
    let mut offset = from;
    for piece in body.get(from..).unwrap_or_default().chunks(TABLE_CHUNK_BYTES) {
        let chunk = TableChunk { offset: offset as u32, bytes: piece.iter().copied().collect() };
        pending.push_back(link.begin_request(Command::TableWrite(chunk)));
        offset += piece.len();
        if pending.len() > PENDING {
            pending.pop_front().map_or(Ok(()), PendingRequest::wait)?;
        }
        progress.advance("table", (offset as u64, body.len() as u64));
    }
    pending.into_iter().try_for_each(PendingRequest::wait)
}

/// Reads the table of a board.
///
/// # Errors
/// [`TransferError`].
pub fn pull(link: &Link, progress: &mut dyn Progress) -> Result<PulledTable, TransferError> {
    let events = link.subscribe();
    let state = state(link)?;
    match state.status {
        TableStatus::InUse | TableStatus::Unusable => {}
        TableStatus::Missing => return Err(TransferError::NoTable("none was stored")),
        TableStatus::Damaged => return Err(TransferError::NoTable("the stored one is damaged")),
        TableStatus::Foreign => return Err(TransferError::NoTable("the stored one is of another version")),
    }
    let length = (state.image_bytes + state.source_bytes) as usize;
    let mut body = Vec::with_capacity(length);
    while body.len() < length {
        let chunk = read(link, &events, body.len() as u32)?;
        if chunk.bytes.is_empty() {
            return Err(TransferError::Damaged);
        }
        body.extend_from_slice(&chunk.bytes);
        progress.advance("table", (body.len() as u64, length as u64));
    }
    let source = body.get(state.image_bytes as usize..length).ok_or(TransferError::Damaged)?;
    if body_crc([&body[..]]) != state.crc {
        return Err(TransferError::Damaged);
    }
    Ok(PulledTable { toml: expand(source)?, generation: state.generation })
}

/// Reads the piece of the table at an offset, again where the line or a full buffer of the board has lost it.
fn read(link: &Link, events: &Subscription, offset: u32) -> Result<TableChunk, TransferError> {
    let mut attempts = 0;
    loop {
        link.request(Command::TableRead(offset))?;
        match next_chunk(events, offset) {
            Err(TransferError::NoState) if attempts < RESUMPTIONS => attempts += 1,
            result => return result,
        }
    }
}

/// Requests the table of a board.
///
/// # Errors
/// [`TransferError`]; a board of an earlier version sends no state.
pub fn on_board(link: &Link) -> Result<TableOnBoard, TransferError> {
    let state = state(link)?;
    let hello = link.state().hello;
    let (arm, checksum) = hello.map_or((String::new(), 0), |hello| (hello.arm.as_str().to_owned(), hello.table));
    Ok(TableOnBoard { arm, checksum, state })
}

fn state(link: &Link) -> Result<TableState, TransferError> {
    link.wait_until_connected()?;
    let events = link.subscribe();
    link.request(Command::Ping)?;
    next_state(&events)
}

/// Erases the table of a board, which restarts without one.
///
/// # Errors
/// [`TransferError`].
pub fn erase(link: &Link) -> Result<Hello, TransferError> {
    link.wait_until_connected()?;
    let events = link.subscribe();
    link.request(Command::TableErase)?;
    next_hello(&events)
}

/// The `Hello` of the board's next boot.
fn next_hello(events: &Subscription) -> Result<Hello, TransferError> {
    let mut restarted = false;
    next(events, RESTART, |kind| {
        restarted |= matches!(kind, EventKind::Restarted);
        match kind {
            EventKind::Message(Message::Hello(hello)) if restarted => Some(hello.clone()),
            _ => None,
        }
    })
}

fn next_state(events: &Subscription) -> Result<TableState, TransferError> {
    next(events, MESSAGE, |kind| match kind {
        EventKind::Message(Message::Table(state)) => Some(*state),
        _ => None,
    })
}

fn next_chunk(events: &Subscription, offset: u32) -> Result<TableChunk, TransferError> {
    next(events, MESSAGE, |kind| match kind {
        EventKind::Message(Message::TableData(chunk)) if chunk.offset == offset => Some(chunk.clone()),
        _ => None,
    })
}

/// The first event that `pick` takes.
fn next<T>(
    events: &Subscription,
    wait: Duration,
    mut pick: impl FnMut(&EventKind) -> Option<T>,
) -> Result<T, TransferError> {
    let end = Instant::now() + wait;
    loop {
        let left = end.saturating_duration_since(Instant::now());
        let event = events.next(left).ok_or(TransferError::NoState)?;
        if let Some(found) = pick(&event.kind) {
            return Ok(found);
        }
    }
}
