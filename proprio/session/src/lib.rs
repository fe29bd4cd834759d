//! Sessions of an arm: CSV with one row per sample, units in the column names and an empty cell for a missing reading; or a
//! board's recording.
//!
//! | file or folder | purpose |
//! |---|---|
//! | `row.rs`, `required_columns.rs`, `table.rs` | a row; the columns that a table needs of it; a table with its path |
//! | `reader.rs`, `defects.rs` | [`SessionReader`]: the rows of a session of any kind; defects of its file |
//! | `csv_file.rs`, `csv_rows.rs`, `column_names.rs`, `columns.rs`, `cell.rs`, `header.rs`, `line_limit.rs`, `source.rs` | CSV files |
//! | `file_content.rs`, `foreign_file.rs`, `missing_column.rs`, `time_unit.rs`, `shown.rs` | likely reasons of errors: a file in place of another, another name, another unit; a file's text in messages |
//! | `camera.rs`, `motion_capture/`, `pressures.rs` | a camera's poses, in a file of ours or in a motion-capture program's export; pressures over time |
//! | `row_assembler.rs` | [`RowAssembler`]: rows from the messages of a board, recorded or live |
//! | `recording/` | MCAP: written, read, recovered |
//! | `convert/` | conversion from one kind to another |
//! | `clock.rs`, `clock_sync.rs`, `boot_tracker.rs` | time of arrival; the board's time on the host's clock; restarts of a board |
//! | `duration.rs`, `utc.rs`, `output.rs`, `progress.rs`, `ellipse.rs` | range of durations; days and times of day; files that are complete or absent; progress of long work; the 95 % ellipse |

mod boot_tracker;
mod camera;
mod cell;
mod clock;
mod clock_sync;
mod column_names;
mod columns;
pub mod convert;
mod csv_file;
mod csv_rows;
mod csv_writer;
mod defects;
mod degradation;
mod duration;
mod ellipse;
mod error;
mod file_content;
mod foreign_file;
mod header;
mod line_limit;
mod missing_column;
mod missing_history;
mod motion_capture;
mod output;
mod pressures;
mod progress;
mod reader;
pub mod recording;
mod required_columns;
mod row;
mod row_assembler;
mod session_error;
mod shown;
mod source;
mod table;
mod time_unit;
mod utc;
mod version;

pub use boot_tracker::{BootTracker, Continuity};
pub use camera::{CameraFrame, CameraReader};
pub use clock::{HostClock, HostNs};
pub use clock_sync::{ClockDrift, ClockSync};
pub use column_names::{SENSOR_NAMES, TARE};
pub use csv_writer::{CsvLayout, ImuForm};
pub use defects::FileDefects;
pub use degradation::degradations;
pub use duration::{DurationError, check_seconds};
pub use ellipse::{CHI2_2_95, Ellipse};
pub use error::Error;
pub use file_content::FileContent;
pub use foreign_file::ForeignFile;
pub use header::Header;
pub use missing_column::{MissingColumn, MissingReason};
pub use missing_history::MissingHistory;
pub use motion_capture::{Axis, BodySelection, MotionCaptureProblem};
pub use output::{Existing, OutputFile, WrittenFile, discard_unfinished, is_stdout};
pub use pressures::{PressurePoint, read_pressures};
pub use progress::{NoProgress, Progress};
pub use reader::SessionReader;
pub use required_columns::RequiredColumns;
pub use row::{BoardOutput, Mark, Pose, Row, Truth};
pub use row_assembler::RowAssembler;
pub use session_error::{SessionError, SessionProblem};
pub use source::FileFormat;
pub use table::{LoadedTable, recorded_table};
pub use time_unit::{time_factor, time_unit_of};
pub use utc::{today, utc_minute};
pub use version::is_version_0_1;
