//! Postcard's form of a message's body.

use serde::{Deserialize, Serialize};

/// Writes a value and returns its length in bytes; `None` if it does not fit.
pub fn write<T: Serialize>(value: &T, body: &mut [u8]) -> Option<usize> {
    postcard::to_slice(value, body).ok().map(|used| used.len())
}

/// Reads a value that takes all of `body`.
pub fn read<'b, T: Deserialize<'b>>(body: &'b [u8]) -> Option<T> {
    postcard::take_from_bytes(body).ok().and_then(|(value, rest)| rest.is_empty().then_some(value))
}
