//! The firmware with an arm's table, onto a board: built, written, and heard.
//!
//! | file | what it is for |
//! |---|---|
//! | `commands.rs` | which commands do it, and their running |
//! | `verify.rs` | that the board has it: by its `Hello` |
//! | `error.rs` | why a board is not flashed |

mod commands;
mod error;
mod verify;

pub use commands::{Flashing, Step};
pub use error::FlashError;
pub use verify::verify;
