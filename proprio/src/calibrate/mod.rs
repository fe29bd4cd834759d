//! Calibration: an arm description and a session with camera truth become a table.
//!
//! 1. Each bend sensor's quadratic is fitted to the truth by least squares (paper, eq. 1), after checks that name a
//!    sensor that is dead, saturated, swapped or bent back.
//! 2. Plays on top of the quadratics correct hysteresis, where that is worth it on a part of the session held back.
//! 3. The session is replayed with these maps and the drift observer; the errors that bend sensors and IMUs make give the filters' default
//!    parameters.
//! 4. What else goes beyond the paper is set: contact, and how far an estimate may be off.

mod beyond;
mod error;
mod fit;
mod hysteresis;
mod imus;
mod residuals;
mod sensors;
mod sweep;

use std::path::Path;

use calibration_tables::{ArmFile, BendKeys, DriftKeys};

pub use error::{CalibrationError, Warning};
pub use hysteresis::Correct;
pub(crate) use residuals::truth_misfit;

use crate::error::Error;
use crate::replay::NamedTable;
use sweep::Sweep;

/// Truth whose tip lies further from the chain of its own headings than constant curvature explains, % of the length:
/// a real arm has 3 %.
pub(crate) const MISFIT_PERCENT: f64 = 10.0;

/// What was found of one bend sensor.
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

/// A table and how good it is.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The table.
    pub table: ArmFile,
    /// One report for each bend sensor.
    pub sensors: Vec<SensorReport>,
    /// What deserves a look.
    pub warnings: Vec<Warning>,
}

/// Calibrates `arm` on a session with truth; `hysteresis` says which segments are corrected for it.
///
/// # Errors
/// [`Error::Session`] where the session cannot be used, [`Error::Calibration`] where no good table can be made of it.
pub fn calibrate(session: &Path, arm: &NamedTable, hysteresis: Correct) -> Result<Calibration, Error> {
    let refuse = |source| Error::Calibration { path: session.to_owned(), source };
    let sweep = Sweep::read(session, &arm.file)?;
    let mut warnings = sweep.check_range().map_err(refuse)?;
    warnings.extend(imus::check(&sweep).map_err(refuse)?);
    let sensors = sensors::fit(&sweep, &mut warnings).map_err(refuse)?;

    let mut table = ArmFile { tuning: None, ..arm.file.clone() };
    for (i, segment) in table.segments.iter_mut().enumerate() {
        let of_segment = sensors.iter().filter(|sensor| sensor.segment == i);
        segment.bend = Some(of_segment.map(|sensor| sensor.map.clone()).collect::<Vec<BendKeys>>());
        (segment.orient, segment.coord) = (None, None);
    }
    hysteresis::set(&sweep, &mut table.segments, hysteresis);
    table.drift.get_or_insert_with(DriftKeys::kalman);
    let mut table = NamedTable { file: table, path: arm.path };
    let misfit_m = residuals::set_filters(session, &mut table, sweep.rate_hz)?;
    let percent = misfit_m * 1e5 / table.file.length_mm();
    if percent > MISFIT_PERCENT {
        return Err(refuse(CalibrationError::TruthMisfit { percent }));
    }
    beyond::set(&sweep, misfit_m, &mut table.file);
    Ok(Calibration { table: table.file, sensors: sensors.into_iter().map(|sensor| sensor.report).collect(), warnings })
}
