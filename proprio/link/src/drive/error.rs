//! Why a board is not driven, or not any more.

use crate::LinkError;

/// What keeps pressures from being driven.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The board has another table than the one that was given.
    #[error("the pressures stay vented: {0}")]
    OtherTable(String),
    /// The firmware has crashed before it came up.
    #[error("the pressures stay vented: the firmware has crashed before this start: {0}")]
    Crashed(String),
    /// Too little is known of the arm's shape.
    #[error("the pressures stay vented: no IMU reads well")]
    Blind,
    /// The board was asked for pressures and does not follow.
    #[error(
        "the board keeps pressure {regulator} at {board_kpa:.1} kPa, asked for {asked_kpa:.1} kPa; all are vented now"
    )]
    HeldBack {
        /// The regulator, from 1.
        regulator: usize,
        /// The board's set-point.
        board_kpa: f64,
        /// The least that was asked for of late.
        asked_kpa: f64,
    },
    /// The board has started anew.
    #[error("the board has restarted, which vents it")]
    Restarted,
    /// The line is gone.
    #[error("{0}; the board vents by itself within 1.5 s")]
    Lost(String),
    /// A request was not done.
    #[error(transparent)]
    Link(#[from] LinkError),
}
