//! The faults that the board survives: each with its promise, injected by name, and measured on the board's stream.
//!
//! The arm swings freely under the board's pressures, in a session of seed 1, for 15 s before the fault. A promise
//! about the estimate is measured as the tip's distance from the truth, compared with the same session without the fault.

mod board;
mod measured;
mod sensors;

pub(crate) use measured::ADDED_MM;
pub use measured::{Measured, Row};

/// All rows, by the names of their functions.
pub fn rows() -> impl Iterator<Item = (&'static str, Row)> {
    sensors::ROWS.iter().chain(board::ROWS).copied()
}

/// Runs the trial of a row.
///
/// # Panics
/// If there is no such row.
#[must_use]
pub fn measure(name: &str) -> Measured {
    let (_, row) = rows().find(|(row, _)| *row == name).expect("a row");
    row()
}
