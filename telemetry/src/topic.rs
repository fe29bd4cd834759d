//! Numbers of the kinds of messages. A number is never reused for another kind.

/// [`Hello`](crate::Hello), from the board.
pub const HELLO: u8 = 1;
/// [`Sample`](crate::Sample), from the board.
pub const SAMPLE: u8 = 2;
/// [`Estimate`](crate::Estimate), from the board.
pub const ESTIMATE: u8 = 3;
/// [`Health`](crate::Health), from the board.
pub const HEALTH: u8 = 4;
/// [`Event`](crate::Event), from the board.
pub const EVENT: u8 = 5;
/// [`Reply`](crate::Reply), from the board.
pub const REPLY: u8 = 6;
/// [`Uncertainty`](crate::Uncertainty), from the board.
pub const UNCERTAINTY: u8 = 7;
/// [`TableState`](crate::TableState), from the board.
pub const TABLE: u8 = 8;
/// [`TableChunk`](crate::TableChunk), from the board.
pub const TABLE_DATA: u8 = 9;
/// [`TareReport`](crate::TareReport), from the board.
pub const TARE: u8 = 10;
/// [`Request`](crate::Request), from the host.
pub const REQUEST: u8 = 0x80;
