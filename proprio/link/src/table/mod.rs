//! The table on the board: its stored form, its wiring, and its transfer over the line.

mod error;
mod stored;
mod transfer;
mod wiring;

pub use error::TableImageError;
pub use stored::StoredTable;
pub use transfer::{PulledTable, TransferError, erase, pull, push, state};
pub use wiring::wiring;
