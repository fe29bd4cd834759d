//! Bodies of the messages and requests about the table in the board's flash.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::constants::TABLE_CHUNK_BYTES;

/// A table that a host is about to send.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TableAnnouncement {
    /// Length of the image, which the board reads, bytes.
    pub image_bytes: u32,
    /// Length of the source, which the board stores as it is, bytes.
    pub source_bytes: u32,
    /// CRC-32 of image and source.
    pub crc: u32,
}

/// A piece of a table: of its image, followed by its source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TableChunk {
    /// Offset of the first byte.
    pub offset: u32,
    /// The bytes.
    pub bytes: heapless::Vec<u8, TABLE_CHUNK_BYTES>,
}

/// The table in the board's flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TableState {
    /// Its state.
    pub status: TableStatus,
    /// Number of the table: each stored one has a higher number than the one before it; 0 without a table.
    pub generation: u32,
    /// Length of its image, bytes; 0 without a table.
    pub image_bytes: u32,
    /// Length of its source, bytes; 0 without a table.
    pub source_bytes: u32,
    /// CRC-32 of image and source; 0 without a table.
    pub crc: u32,
    /// Bytes received of the transfer under way: the offset of the next piece.
    pub received_bytes: u32,
}

/// State of the table in the board's flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableStatus {
    /// Whole, and in use.
    InUse,
    /// No table was stored.
    Missing,
    /// A checksum is wrong.
    Damaged,
    /// Of another format version.
    Foreign,
    /// Not used: for more segments or a longer window than the firmware has room for, or the board crashed three times
    /// before its first tick.
    Unusable,
}
