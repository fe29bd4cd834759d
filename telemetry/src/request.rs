//! Requests from the host and the board's replies.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::constants::MAX_REGULATORS;
use crate::table_message::{TableAnnouncement, TableChunk};

/// A request from the host.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request {
    /// The host's number of the request. A retried request keeps its number and acts once; numbers go up.
    pub id: u32,
    /// The session that the board named in its reply to the Ping; a Ping may have any.
    pub session: u16,
    /// The command to execute.
    pub command: Command,
}

/// A command to the board.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Reply, then send a [`Hello`](crate::Hello).
    Ping,
    /// Restart the estimator: the arm is in its reference pose. The reply is followed by a [`TareReport`].
    Tare(TareMode),
    /// Set the rates of the periodic messages.
    Rates(Rates),
    /// Let the pressures move.
    Arm,
    /// Vent, and let nothing move the pressures until armed again.
    Disarm,
    /// Set the pressures.
    SetPressures(SetPressures),
    /// Vent and restart.
    Reboot,
    /// Begin the transfer of a table to the board's flash, or resume it; the reply is followed by a [`TableState`](crate::TableState).
    TableBegin(TableAnnouncement),
    /// Store the next piece of the table.
    TableWrite(TableChunk),
    /// End the transfer: check the table, make it the board's, and restart.
    TableCommit,
    /// Send the piece of the table, image first, that begins at this offset, as [`Message::TableData`](crate::Message::TableData).
    TableRead(u32),
    /// Erase the board's table, and restart.
    TableErase,
}

/// Condition of a tare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TareMode {
    /// Refused while the arm moves.
    IfStill,
    /// At once.
    Force,
}

/// Pose of the arm at a request to tare, in the half second before it. Angles are in units of 2⁻²⁶ rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TareReport {
    /// Number of the request.
    pub id: u32,
    /// Segment, counted from 0, whose heading turned most, and its range; `None`: no IMU was read throughout.
    pub turned: Option<(u8, i32)>,
    /// Segment, counted from 0, with the largest bend angle by its bend sensors, and that angle; `None`: none was read.
    pub bent: Option<(u8, i32)>,
}

/// Periods of the periodic messages, in ticks of 10 ms; 0: never.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rates {
    /// Ticks from one sample to the next.
    pub sample: u16,
    /// Ticks from one estimate to the next.
    pub estimate: u16,
    /// Ticks from one health message to the next.
    pub health: u16,
    /// Ticks from one uncertainty to the next.
    pub uncertainty: u16,
}

/// Set-points with a deadline.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SetPressures {
    /// Gauge pressure of each regulator, Pa.
    pub pressures_pa: Vec<u32, MAX_REGULATORS>,
    /// Time until the deadline, ms; after it the pressures are held, lowered and vented.
    pub valid_ms: u16,
}

/// Reply to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reply {
    /// The request's number.
    pub id: u32,
    /// The board's session: requests of another are refused as [`Refusal::Session`].
    pub session: u16,
    /// Outcome of the request.
    pub outcome: RequestOutcome,
}

/// Outcome of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RequestOutcome {
    /// It was executed.
    Ack,
    /// It was refused, and nothing has changed.
    Nack(Refusal),
    /// Set-points were accepted, but none may rise: sensors are lost, so that the shape is too uncertain
    /// ([`PressureLimit`](crate::PressureLimit)).
    Limited,
}

/// Reason for a refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The frame is valid but its body is no request of this protocol's version.
    #[error("the board does not know this request: host and firmware are of different versions")]
    Unknown,
    /// Its number is lower than that of an earlier request.
    #[error("the request is older than one already done")]
    Late,
    /// A pressure is over the regulator's range.
    #[error("a pressure is over the regulator's range")]
    OverRange,
    /// The deadline is zero or too far away.
    #[error("the time that the pressures stand must be 1 ms to 1000 ms")]
    Deadline,
    /// The pressures move only when armed.
    #[error("the pressures are not armed: arm first")]
    Disarmed,
    /// Too many requests at once.
    #[error("too many requests: wait and try again")]
    Busy,
    /// The table is not changed while the pressures are armed.
    #[error("the pressures are armed: disarm first")]
    Armed,
    /// The board has no valid table.
    #[error("the board has no valid table: send it one with `proprio table push`")]
    NoTable,
    /// The table is longer than its place on the board.
    #[error("the table is longer than its place on the board")]
    TableTooLong,
    /// The table has more segments or a longer window than the firmware has room for.
    #[error("the table has more segments or a longer window of the anchor than the firmware has room for")]
    TableCapacity,
    /// The table's image is none of this firmware's format.
    #[error("the firmware cannot read the table: host and firmware are of different versions")]
    TableImage,
    /// A piece of the table does not follow the one before it.
    #[error("a piece of the table was lost: begin the transfer again")]
    TableOrder,
    /// The checksum of the stored table is wrong.
    #[error("the checksum of the stored table is wrong: begin the transfer again")]
    TableChecksum,
    /// A page of the flash did not take what was written.
    #[error("the board's flash did not take what was written")]
    Flash,
    /// The arm moves, so that no zero can be taken.
    #[error("the arm is moving: let it rest in its reference pose")]
    Moving,
    /// It has set-points for more or fewer regulators than the arm has.
    #[error("it has another number of set-points than the arm has regulators")]
    Regulators,
    /// The table's wiring does not fit the board.
    #[error("the table's wiring does not fit the board")]
    TableWiring,
    /// The request is of an earlier session: its bytes were delayed or sent again.
    #[error("the request belongs to an earlier session of the line")]
    Session,
    /// The board restarted after repeated crashes, and keeps the pressures at zero.
    #[error("the board is in safe mode after repeated crashes: reset it by its button once the cause is found")]
    SafeMode,
}
