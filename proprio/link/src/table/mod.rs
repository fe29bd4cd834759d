//! The table on the board: its stored form, and its transfer over the line.

mod stored;
mod transfer;

pub use stored::{StoredTable, TableImageError};
pub use transfer::{PulledTable, TransferError, erase, pull, push, state};
