//! Flashing: writes the firmware onto a board and verifies it.
//!
//! | file | purpose |
//! |---|---|
//! | `plan.rs` | the steps |
//! | `tools.rs`, `command.rs` | the programs that write the flash, and their commands |
//! | `touch.rs` | the reset into the boot loader |
//! | `verify.rs` | verification by the board's `Hello` |
//! | `error.rs` | errors |

mod command;
mod error;
mod plan;
mod tools;
mod touch;
mod verify;

pub use command::ToolCommand;
pub use error::FlashError;
pub use plan::{Firmware, Step, plan};
pub use tools::Flasher;
pub use verify::verify;
