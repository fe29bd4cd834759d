//! Flashing: builds the firmware with an arm's table, writes it onto a board and verifies it.
//!
//! | file | purpose |
//! |---|---|
//! | `commands.rs` | the commands |
//! | `verify.rs` | verification by the board's `Hello` |
//! | `error.rs` | errors |

mod commands;
mod error;
mod verify;

pub use commands::{FlashCommand, Flashing};
pub use error::FlashError;
pub use verify::verify;
