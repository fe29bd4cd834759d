//! Tables of soft robot arms: what a calibration is written to, checked when it is read, and made into the
//! estimator's parameters.
//!
//! [`ArmFile`] is the TOML file as it stands, in the units that people read (mm, degrees, volts). [`ArmFile::load`]
//! refuses what the estimator could not use and names the key. A file with geometry alone is an *arm description*, what
//! a calibration starts from; once every segment says what bend sensors it has, it is a *table*, and
//! [`ArmFile::bake`] turns it into an [`estimator_core::ArmConfig`] for one sample rate.
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
//! let baked = table.bake::<Q>(100.0)?;
//! let config = baked.config();
//! assert!(Estimator::<Q, 1, 100>::new(&config).is_ok());
//! # Ok::<(), calibration_tables::FileError>(())
//! ```

mod bake;
mod bend;
mod check;
mod contact;
mod drift;
mod file;
mod noise;
mod place;
mod source;
mod tuning;
mod uncertainty;

pub use bake::Baked;
pub use bend::{BendErrorKeys, CURVE_POINTS, CurveKeys, MemoryKeys};
pub use check::H_RANGE;
pub use contact::{ChangeKeys, ContactKeys, CoupledKeys, RATIO_RANGE};
pub use drift::{DriftKeys, DriftKind};
pub use file::{
    AnchorKeys, ArmFile, BendKeys, FileError, MAX_SEGMENTS, MAX_WINDOW, NoiseKeys, PlayKeys, SegmentKeys, Side,
    TareKeys,
};
pub use noise::{LAG_S, RMSE_DEG_UNKNOWN};
pub use tuning::{DriftTuningKeys, RmseKeys, Stopped, TuningKeys};
pub use uncertainty::UncertaintyKeys;

/// The reference arm's description, `arms/planar-6.toml`.
pub const PLANAR_6_ARM: &str = include_str!("../arms/planar-6.toml");
