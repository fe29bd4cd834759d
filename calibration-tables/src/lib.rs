//! Calibration tables of soft robot arms: the TOML format, its validation, and its compilation to the estimator's
//! configuration.
//!
//! [`ArmFile`] holds the keys of the TOML file in their units (mm, degrees, volts). [`ArmFile::load`] rejects values
//! that the estimator cannot use, and names the key. A file with geometry alone is an *arm description*, the input of a
//! calibration; if every segment has the key `bend` it is a *table*, which [`ArmFile::compile`] converts to an
//! [`estimator_core::ArmConfig`] for one sample rate.
//!
//! ```
//! use calibration_tables::ArmFile;
//! use estimator_core::{Estimator, Q};
//!
//! let table = ArmFile::parse(
//!     r#"
//!     format = 1
//!     arm = "finger"
//!     rate_hz = 100.0
//!     [[segment]]
//!     length_mm = 80.0
//!     offset_mm = 17.0
//!     offset_at = "end"
//!     bend = [{ c0 = -1.5, c1 = 0.8, c2 = 0.1, rmse_deg = 4.7, volts = [0.4, 2.6] }]
//!     "#,
//! )?;
//! let compiled = table.compile::<Q>(100.0)?;
//! let config = compiled.config();
//! assert!(Estimator::<Q, 1, 100>::new(&config).is_ok());
//! # Ok::<(), calibration_tables::FileError>(())
//! ```
//!
//! # Firmware
//!
//! This crate needs `std` and belongs in a firmware's `[build-dependencies]`; in its `[dependencies]` the build for a
//! target without an operating system fails. The firmware itself depends on [`estimator_core`] alone:
//!
//! ```toml
//! [dependencies]
//! estimator-core = "0.2"
//!
//! [build-dependencies]
//! calibration-tables = "0.2"
//! estimator-core = "0.2"
//! ```
//!
//! The build script `build.rs` compiles the table to Rust source:
//!
//! ```no_run
//! use std::path::PathBuf;
//! use std::{env, fs};
//!
//! use calibration_tables::ArmFile;
//! use estimator_core::Q;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let table = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("arm.toml");
//!     println!("cargo::rerun-if-changed={}", table.display());
//!     let source = ArmFile::load(&table)?.compile::<Q>(100.0)?.to_rust();
//!     fs::write(PathBuf::from(env::var("OUT_DIR")?).join("table.rs"), source)?;
//!     Ok(())
//! }
//! ```
//!
//! The firmware includes the source and passes `TABLE` to the estimator:
//!
//! ```ignore
//! #[expect(clippy::unreadable_literal, reason = "generated")]
//! mod table {
//!     include!(concat!(env!("OUT_DIR"), "/table.rs"));
//! }
//!
//! let mut estimator = estimator_core::Estimator::<estimator_core::Q, 6, 100>::new(&table::TABLE)?;
//! ```
//!
//! `estimator-core/examples/no-std-table` in the repository is a complete program.

mod arm;
mod bend;
mod bend_error;
mod board;
mod calibration;
mod codegen;
mod compile;
mod contact;
mod drift;
mod error;
mod file;
mod noise;
mod segment;
mod span;
mod tuning;
mod uncertainty;
mod variance;

// Types of this crate are in public signatures.
pub use estimator_core;

pub use arm::{AnchorToml, ArmFile, MAX_SEGMENTS, MAX_WINDOW, TareToml};
pub use bend::{BendToml, CURVE_POINTS, CurveToml, MemoryToml};
pub use bend_error::BendErrorToml;
pub use board::{AnalogPin, BoardSegmentToml, BoardToml, DigitalPin, ImuToml, RegulatorToml};
pub use calibration::CalibrationToml;
pub use compile::CompiledTable;
pub use contact::{ChangeToml, ContactToml, CoupledToml, RATIO_RANGE};
pub use drift::{DriftKind, DriftToml};
pub use error::FileError;
pub use noise::{H_RANGE, LAG_S, NoiseToml, RMSE_DEG_UNKNOWN};
pub use segment::{PlayToml, SegmentToml, Side};
pub use tuning::{DriftTuningToml, RmseToml, StopReason, TuningToml};
pub use uncertainty::UncertaintyToml;

/// The reference arm's table, `planar-6.toml`.
pub const PLANAR_6_TABLE: &str = include_str!("../planar-6.toml");

/// The reference arm's description, `arms/planar-6.toml`.
pub const PLANAR_6_ARM: &str = include_str!("../arms/planar-6.toml");
