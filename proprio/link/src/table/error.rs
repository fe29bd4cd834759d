//! Reasons why a table cannot be stored on a board.

use std::io;

use board_table::{ANALOG_PINS, MAX_SEGMENTS, TableError};
use calibration_tables::FileError;

/// Reason why a table cannot be stored on a board.
#[derive(Debug, thiserror::Error)]
pub enum TableImageError {
    /// Some segments are calibrated and others are not, or the file is no table.
    #[error(transparent)]
    File(#[from] FileError),
    /// The arm has more segments than the board has room for.
    #[error("the arm has {0} segments, and the board has room for {MAX_SEGMENTS}")]
    Segments(usize),
    /// The arm has more bend sensors than the board has analog pins.
    #[error("the arm has {0} bend sensors, and the board has {ANALOG_PINS} analog pins")]
    BendSensors(usize),
    /// A segment has more bend sensors than the reference wiring has pins for.
    #[error("the reference wiring has {pins} pins for segment {segment}, which has {sensors} bend sensors")]
    ReferencePins {
        /// Segment, from 1.
        segment: usize,
        /// Its bend sensors in the table.
        sensors: usize,
        /// Its pins in the reference wiring.
        pins: usize,
    },
    /// It does not fit the board.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The source cannot be compressed or expanded.
    #[error("the table's source: {0}")]
    Source(#[from] io::Error),
}
