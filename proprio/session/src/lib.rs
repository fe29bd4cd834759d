//! Sessions of an arm: CSV, a row a sample, units in the column names, an empty cell for a missing reading; or a board's
//! recording.
//!
//! | file or folder | purpose |
//! |---|---|
//! | `row.rs`, `needs.rs`, `table.rs` | a row; the columns that a table needs of it; a table with its path |
//! | `reader.rs` | [`SessionReader`]: the rows of a session of any kind |
//! | `csv_file.rs`, `csv_rows.rs`, `columns.rs`, `cell.rs`, `header.rs`, `source.rs` | CSV files |
//! | `camera.rs`, `pressures.rs` | a camera's poses; pressures over time |
//! | `recording/` | MCAP: written, read, recovered; rows from a board's bytes |
//! | `convert/` | conversion from one kind to another |
//! | `clock.rs`, `board_clock.rs`, `boot_tracker.rs` | time of arrival; the board's time on the host's clock; restarts of a board |
//! | `duration.rs`, `output.rs`, `progress.rs`, `ellipse.rs` | range of durations; files that are complete or absent; progress of long work; the 95 % ellipse |

mod board_clock;
mod boot_tracker;
mod camera;
mod cell;
mod clock;
mod columns;
pub mod convert;
mod csv_file;
mod csv_rows;
mod duration;
mod ellipse;
mod error;
mod header;
mod needs;
mod output;
mod pressures;
mod progress;
mod reader;
pub mod recording;
mod row;
mod session_error;
mod source;
mod table;
mod version;

pub use board_clock::{BoardClock, Drift};
pub use boot_tracker::{BootTracker, Continuity};
pub use camera::{CameraReader, Frame};
pub use clock::{HostClock, HostNs};
pub use columns::{SENSOR_NAMES, TARE};
pub use duration::{DurationError, check_seconds};
pub use ellipse::{CHI2_2_95, Ellipse};
pub use error::Error;
pub use header::Header;
pub use needs::Needs;
pub use output::{OutputFile, discard_unfinished};
pub use pressures::{Moment, read_pressures};
pub use progress::{NoProgress, Progress};
pub use reader::SessionReader;
pub use row::{Mark, OnBoard, Pose, Row, Truth};
pub use session_error::{Problem, SessionError};
pub use source::Kind;
pub use table::NamedTable;
pub use version::is_version_0_1;

/// Warning about a file whose last line has no line end.
pub const LAST_LINE: &str = "the last line has no end; its last number may be cut";
