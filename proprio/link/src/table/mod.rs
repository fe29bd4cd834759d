//! The table on the board: its stored form, its wiring, and its transfer over the line.

mod error;
mod stored;
mod transfer;
mod wiring;

pub use error::TableImageError;
pub use stored::StoredTable;
pub use transfer::{PulledTable, TableOnBoard, TransferError, erase, on_board, pull, push};
pub use wiring::wiring;
