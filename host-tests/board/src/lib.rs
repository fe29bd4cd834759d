//! The firmware on the emulated board, as a host sees it: frames out, requests in, and the arm's truth beside them.

mod board;
#[cfg(unix)]
pub mod browser;
mod build;
pub mod due;
mod replay;
mod view;

pub use board::{Board, Received, UART};
pub use build::{elf, firmware};
pub use replay::{Replayed, replay, table};
pub use view::View;
