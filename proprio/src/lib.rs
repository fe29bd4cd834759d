//! The host side of `proprio`: sessions, calibration, replay, reports, simulation, the link to a board, and its live page.
//!
//! The command-line tool is a thin layer over these modules; the tests and benchmarks of the workspace use them as well.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use estimator_core::Q;
//! use proprio::replay::{NamedTable, replay};
//! use proprio::score::Score;
//!
//! let table = NamedTable::load(Path::new("table.toml"))?;
//! let mut score = Score::new(table.file.length_mm());
//! replay::<Q>(Path::new("session.csv"), &table, |row, outcome| {
//!     score.add(row, outcome);
//!     Ok(())
//! })?;
//! println!("{:?}", score.figures());
//! # Ok::<(), proprio::error::Error>(())
//! ```

pub mod align;
pub mod calibrate;
pub mod convert;
pub mod distances;
pub mod drive;
pub mod error;
pub mod estimates;
pub mod figures;
pub mod flash;
pub mod honesty;
pub mod interrupt;
pub mod link;
pub mod monitor;
pub mod output;
pub mod progress;
pub mod recording;
pub mod replay;
pub mod report;
pub mod score;
pub mod session;
pub mod simulate;
pub mod smooth;
pub mod status;
pub mod tune;
