//! Replay of recorded sessions: error metrics, smoothed estimates, reports.
//!
//! ```no_run
//! use std::path::Path;
//!
//! use estimator_core::Q;
//! use proprio_analysis::metrics::ErrorMetrics;
//! use proprio_analysis::replay::replay;
//! use proprio_session::{LoadedTable, NoProgress};
//!
//! let table = LoadedTable::load(Path::new("table.toml"))?;
//! let mut errors = ErrorMetrics::new(table.file.length_mm());
//! replay::<Q>(Path::new("session.csv"), &table, &mut NoProgress, |row, outcome| {
//!     errors.add(row, outcome);
//!     Ok(())
//! })?;
//! println!("{:?}", errors.metrics());
//! # Ok::<(), proprio_analysis::Error>(())
//! ```
//!
//! | file or folder | purpose |
//! |---|---|
//! | `replay.rs`, `outcome.rs` | a session through the estimator, row by row |
//! | `smooth/` | smoothed estimates, which use the later samples too |
//! | `metrics.rs`, `consistency.rs`, `error_histogram.rs` | errors against truth, and against the estimates' covariances |
//! | `agreement.rs` | a board's estimates compared with a replay |
//! | `session_metrics.rs`, `estimates.rs`, `estimate_recording.rs` | results for people and programs: metrics, and estimates as CSV or as a recording |
//! | `decimal.rs` | decimal numbers as text |
//! | `report/` | a page of plots |

pub mod agreement;
pub mod consistency;
mod decimal;
mod error;
pub mod error_histogram;
pub mod estimate_recording;
pub mod estimates;
pub mod metrics;
mod outcome;
pub mod replay;
pub mod report;
pub mod session_metrics;
pub mod smooth;

pub use error::Error;
pub use outcome::{HostEstimator, Outcome};
