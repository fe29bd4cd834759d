//! The firmware on the emulated board, as a host sees it: received frames, sent requests, and the arm's truth.

mod arms;
mod board;
#[cfg(unix)]
pub mod browser;
mod build;
pub mod due;
pub mod fault_rows;
mod flash;
mod replay;
pub mod soak;
mod trial;
mod view;

pub use arms::WiredArm;
pub use board::{Board, Received, UART};
pub use build::{elf, firmware};
pub use flash::{flash_with, machine, stored_table};
pub use replay::{Replayed, Replica, replay, table};
pub use trial::Trial;
pub use view::View;
