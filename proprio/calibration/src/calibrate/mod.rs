//! Calibration: an arm description and sessions with camera truth become a table.
//!
//! 1. Each bend sensor's quadratic is fitted to the truth by least squares (paper, eq. 1), after checks that name a
//!    sensor that is dead, saturated, swapped or bent back.
//! 2. A monotone curve takes the quadratic's place, and the memory of lags and plays is added to it, where that lowers the
//!    error on parts of the sweep that were held back.
//! 3. What the maps leave of the sweep gives the errors that the bias filter reckons with; the IMUs' turns against the
//!    camera's give their sensitivity.
//! 4. The error sources of the estimates, contact detection and coupled segments are set.
//! 5. The same is done without the last fifth of the session, on which the methods are then compared.
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
mod residuals;
mod sensors;
mod spline;
mod sweep;

use std::path::PathBuf;

use calibration_tables::ArmFile;
use proprio_session::{LoadedTable, Progress};

pub(crate) use curvature::constant_curvature_error;
pub use error::{CalibrationError, Warning};
pub use held_out::HeldOut;
pub use hysteresis::HysteresisMode;
pub use maps::{MapKind, MapMode};

use crate::error::Error;
use sweep::Sweep;

/// Truth whose tip lies further from the chain of its own headings than constant curvature explains, % of the length:
/// a real arm has 3 %.
pub(crate) const MISFIT_PERCENT: f64 = 10.0;

/// Choices of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationOptions {
    /// V–Orient maps.
    pub maps: MapMode,
    /// Compensation of hysteresis and creep.
    pub hysteresis: HysteresisMode,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self { maps: MapMode::Auto, hysteresis: HysteresisMode::Auto }
    }
}

/// Fit of one bend sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorReport {
    /// The sensor, such as `bend3b`.
    pub name: String,
    /// Rows that were fitted.
    pub samples: usize,
    /// Residual of the quadratic, degrees.
    pub rmse_deg: f64,
    /// Voltage range of the map, V.
    pub volts: [f64; 2],
    /// Range of the true bend angle, degrees.
    pub range_deg: [f64; 2],
}

/// Expected error of a segment's bend angle by its bend sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentReport {
    /// Number of the segment, from 1.
    pub segment: usize,
    /// Root mean square error of the sensors' mean on parts of the sweep that were held back, degrees.
    pub held_back_rmse_deg: f64,
    /// Map of each sensor, and whether it has a memory.
    pub maps: Vec<(MapKind, bool)>,
    /// Sensitivity of the segment's IMU, where the table has it.
    pub imu_scale: Option<f64>,
}

/// A table and how good it is.
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
    /// What deserves a look.
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
    let refuse = |source| Error::Calibration { path: sessions.first().cloned().unwrap_or_default(), source };
    let mut warnings = sweep.check_range().map_err(refuse)?;
    warnings.extend(imus::check(&sweep).map_err(refuse)?);
    let derived = derive::table(&sweep, sessions, arm, options, &mut warnings, progress)?;
    let segments = derived.segment_reports(&sweep);
    let held_out = held_out::evaluate(&sweep, sessions, arm, options, progress)?;
    warnings.extend(held_out.as_ref().and_then(HeldOut::warning));
    let sensors = derived.sensors.into_iter().map(|sensor| sensor.report).collect();
    Ok(Calibration { table: derived.table, sensors, segments, held_out, warnings })
}

/// Root mean square.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), value| (sum + value * value, count + 1.0));
    (sum / count.max(1.0)).sqrt()
}

/// Quantile of sorted values, linear between two.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let below = place as usize;
    let (Some(a), b) = (sorted.get(below), sorted.get(below + 1)) else { return 0.0 };
    b.map_or(*a, |b| a + (b - a) * (place - below as f64))
}
