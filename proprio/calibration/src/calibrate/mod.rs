//! Calibration: an arm description and sessions with camera truth become a table.
//!
//! 1. Wrong poses of the truth are left out, and its lengths and clock are compared with the arm's and the IMUs'.
//! 2. Each bend sensor's quadratic is fitted to the truth by least squares (paper, eq. 1), after checks that name a
//!    sensor that is dead, saturated, swapped or not monotonic.
//! 3. A monotone curve replaces the quadratic, and the memory of lags and plays is added to it, where that lowers the
//!    error on parts of the sweep that were held back.
//! 4. The residuals of the maps give the error model of the bias filter; the IMUs' turns compared with the camera's give
//!    their sensitivity.
//! 5. The error sources of the estimates, contact detection and coupled segments are set.
//! 6. The same is done without the last fifth of the session, on which the methods are then compared.
//!
//! An arm description with `[drift] kind = "anchor"` gets the paper's table: quadratics, and KF_orient and KF_coord with
//! the errors that bend sensors and anchored IMUs make in a replay of the sweep.

mod bend_error;
mod contact;
mod curvature;
mod derive;
mod error;
mod extensions;
mod fit;
mod folds;
mod held_out;
mod hysteresis;
mod imu_scale;
mod imus;
mod maps;
mod memory;
mod options;
mod pieces;
mod report;
mod residuals;
mod sensors;
mod spline;
mod statistics;
mod sweep;

use std::path::PathBuf;

use calibration_tables::{ArmFile, CalibrationToml};
use proprio_session::{FileDefects, LoadedTable, Progress};

pub(crate) use curvature::{MISFIT_PERCENT, constant_curvature_error};
pub use error::{CalibrationError, Warning};
pub use held_out::HeldOut;
pub use options::{CalibrationOptions, HysteresisMode, MapKind, MapMode};
pub use report::{SegmentReport, SensorReport};
pub(crate) use sensors::{DEAD_COUNTS, GOOD_ENOUGH, UNRELATED};
pub(crate) use sweep::{COUPLED, GOOD_RANGE_DEG, LEAST_RANGE_DEG};

use crate::error::Error;
use crate::truth::JudgedTruth;
use sweep::Sweep;

/// A table and its quality.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The table.
    pub table: ArmFile,
    /// One report for each bend sensor.
    pub sensors: Vec<SensorReport>,
    /// One report for each segment that has bend sensors.
    pub segments: Vec<SegmentReport>,
    /// Errors on the last fifth of each session, by a table of the rest; `None` where the rest makes no table.
    pub held_out: Option<HeldOut>,
    /// Defects of each session's file.
    pub defects: Vec<FileDefects>,
    /// The truth of each session.
    pub truth: Vec<JudgedTruth>,
    /// Warnings about the table.
    pub warnings: Vec<Warning>,
}

/// Calibrates `arm` on one session with truth or on several, which may be of different days.
///
/// # Errors
/// [`Error::File`] where a session cannot be used, [`Error::Calibration`] where no good table can be made of them.
pub fn calibrate(
    sessions: &[PathBuf],
    arm: &LoadedTable,
    options: CalibrationOptions,
    progress: &mut dyn Progress,
) -> Result<Calibration, Error> {
    let sweep = Sweep::read(sessions, &arm.file, progress)?;
    let refuse = |session: usize, source| Error::Calibration {
        path: sessions.get(session).cloned().unwrap_or_default(),
        source,
    };
    let mut warnings = sweep.check_range().map_err(|source| refuse(0, source))?;
    warnings.extend(imus::check(&sweep).map_err(|(session, source)| refuse(session, source))?);
    let derived = derive::table(&sweep, sessions, arm, options, &mut warnings, progress)?;
    let segments = derived.segment_reports(&sweep);
    let held_out = held_out::evaluate(&sweep, sessions, arm, options, progress)?;
    warnings.extend(held_out.as_ref().and_then(HeldOut::warning));
    let sensors = derived.sensors.into_iter().map(|sensor| sensor.report).collect();
    let name = |session: &PathBuf| session.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let sessions = sessions.iter().map(name).collect();
    let record = CalibrationToml { sessions, date: None };
    Ok(Calibration {
        table: ArmFile { calibration: Some(record), ..derived.table },
        sensors,
        segments,
        held_out,
        defects: sweep.defects,
        truth: sweep.truth,
        warnings,
    })
}
