//! Errors that keep a board from being driven, or end that.

use crate::LinkError;

/// An error that keeps pressures from being driven.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The pressures are for another number of regulators.
    #[error("the pressures stay vented: there are pressures for {given} regulators, and the board's arm has {board}")]
    Regulators {
        /// Regulators of the given pressures.
        given: usize,
        /// Regulators of the board's arm.
        board: usize,
    },
    /// The board has another table than the one that was given.
    #[error("the pressures stay vented: {0}")]
    OtherTable(String),
    /// The firmware crashed before this boot.
    #[error("the pressures stay vented: the firmware has crashed before this start: {0}")]
    Crashed(String),
    /// No IMU is valid, so that the arm's shape is not known.
    #[error("the pressures stay vented: no IMU reads well")]
    Blind,
    /// The board does not follow the requested pressures.
    #[error(
        "the board keeps pressure {regulator} at {board_kpa:.1} kPa, requested {requested_kpa:.1} kPa; all are vented now"
    )]
    HeldBack {
        /// The regulator, from 1.
        regulator: usize,
        /// The board's set-point.
        board_kpa: f64,
        /// Lowest request of the last second.
        requested_kpa: f64,
    },
    /// The board has restarted.
    #[error("the board has restarted, which vents it")]
    Restarted,
    /// The line is gone.
    #[error("{0}; the board vents on its own within 1.5 s")]
    Lost(String),
    /// A request was not done.
    #[error(transparent)]
    Link(#[from] LinkError),
}
