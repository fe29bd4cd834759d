//! Calibration: an arm description and a session with camera truth become a table.
//!
//! 1. Each bend sensor's quadratic is fitted to the truth by least squares (paper, eq. 1), after checks that name a
//!    sensor that is dead, saturated, swapped or bent back.
//! 2. A monotone curve takes the quadratic's place, and the memory of lags and plays is added to it, where that lowers the
//!    error on parts of the sweep that were held back.
//! 3. What the maps leave of the sweep gives the errors that the bias filter reckons with; the IMUs' turns against the
//!    camera's give their sensitivity.
//! 4. The error sources of the estimates, contact detection and coupled segments are set.
//!
//! An arm description with `[drift] kind = "anchor"` gets the paper's table: quadratics, and KF_orient and KF_coord with
//! the errors that bend sensors and anchored IMUs make in a replay of the sweep.

mod bend_error;
mod curvature;
mod error;
mod extensions;
mod fit;
mod folds;
mod hysteresis;
mod imu_scale;
mod imus;
mod maps;
mod memory;
mod residuals;
mod sensors;
mod spline;
mod sweep;

use std::path::Path;

use calibration_tables::{ArmFile, BendKeys, DriftKeys};

pub(crate) use curvature::constant_curvature_error;
pub use error::{CalibrationError, Warning};
pub use hysteresis::HysteresisMode;
pub use maps::{MapKind, MapMode};

use crate::error::Error;
use crate::replay::NamedTable;
use sensors::Sensor;
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
    /// What deserves a look.
    pub warnings: Vec<Warning>,
}

/// Calibrates `arm` on a session with truth.
///
/// # Errors
/// [`Error::Session`] where the session cannot be used, [`Error::Calibration`] where no good table can be made of it.
pub fn calibrate(session: &Path, arm: &NamedTable, options: CalibrationOptions) -> Result<Calibration, Error> {
    let refuse = |source| Error::Calibration { path: session.to_owned(), source };
    let sweep = Sweep::read(session, &arm.file)?;
    let mut warnings = sweep.check_range().map_err(refuse)?;
    warnings.extend(imus::check(&sweep).map_err(refuse)?);
    let mut table = ArmFile { tuning: None, ..arm.file.clone() };
    table.drift.get_or_insert_with(DriftKeys::kalman);
    let is_paper = table.bias_filter().is_none() && options.maps != MapMode::Curve;
    let of_maps = if is_paper {
        CalibrationOptions { maps: MapMode::Quadratic, hysteresis: HysteresisMode::Never }
    } else {
        options
    };
    let sensors = sensors::fit(&sweep, of_maps, &mut warnings).map_err(refuse)?;
    let percent = sweep.tip.rms().unwrap_or(0.0) * 1e5 / table.length_mm();
    if percent > MISFIT_PERCENT {
        return Err(refuse(CalibrationError::TruthMisfit { percent }));
    }
    set_maps(&sensors, &mut table);
    let segments = reports(&sweep, &sensors, &table);
    if is_paper {
        hysteresis::set(&sweep, &mut table.segments, options.hysteresis);
    }
    if table.bias_filter().is_some() {
        set_errors(&sweep, &sensors, &mut table);
    } else {
        let mut named = NamedTable { file: table, path: arm.path };
        residuals::set_filters(session, &mut named, sweep.rate_hz)?;
        table = named.file;
    }
    extensions::set(&sweep, &mut table);
    Ok(Calibration { table, sensors: sensors.into_iter().map(|sensor| sensor.report).collect(), segments, warnings })
}

/// Sets the maps, and clears all else that a calibration sets of the segments.
fn set_maps(sensors: &[Sensor], table: &mut ArmFile) {
    for (i, segment) in table.segments.iter_mut().enumerate() {
        let of_segment = sensors.iter().filter(|sensor| sensor.segment == i);
        segment.bend = Some(of_segment.map(|sensor| sensor.map.clone()).collect::<Vec<BendKeys>>());
        segment.hysteresis.clear();
        (segment.orient, segment.coord) = (None, None);
        (segment.bend_error, segment.imu_scale) = (None, None);
    }
}

/// Sets the errors that the bias filter reckons with, and the IMUs' sensitivity.
fn set_errors(sweep: &Sweep, sensors: &[Sensor], table: &mut ArmFile) {
    let scales = imu_scale::of(sweep);
    for (i, (segment, scale)) in table.segments.iter_mut().zip(scales).enumerate() {
        let of_segment: Vec<_> =
            sensors.iter().filter(|sensor| sensor.segment == i).map(|sensor| &sensor.fitted).collect();
        segment.bend_error = bend_error::of(sweep, i, &of_segment);
        segment.imu_scale = scale;
    }
}

/// The segments' expected errors.
fn reports(sweep: &Sweep, sensors: &[Sensor], table: &ArmFile) -> Vec<SegmentReport> {
    let scales = if table.bias_filter().is_some() { imu_scale::of(sweep) } else { vec![None; table.segments.len()] };
    let report = |(i, imu_scale): (usize, Option<f64>)| {
        let of_segment: Vec<&Sensor> = sensors.iter().filter(|sensor| sensor.segment == i).collect();
        let mean = |row: usize| {
            let errors = || of_segment.iter().filter_map(|sensor| sensor.fitted.held_back[row]);
            let count = errors().count();
            (count > 0).then(|| errors().sum::<f64>() / count as f64)
        };
        let held_back_rmse_deg = rms((0..sweep.runs.len()).filter_map(mean)).to_degrees();
        let maps = of_segment.iter().map(|sensor| (sensor.fitted.kind, sensor.fitted.memory.is_some())).collect();
        (!of_segment.is_empty()).then_some(SegmentReport { segment: i + 1, held_back_rmse_deg, maps, imu_scale })
    };
    scales.into_iter().enumerate().filter_map(report).collect()
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
