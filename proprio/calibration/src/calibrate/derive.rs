//! The table of a sweep.

use std::path::PathBuf;

use calibration_tables::{ArmFile, BendToml, DriftKind, DriftToml};
use proprio_session::{LoadedTable, Progress};

use super::curvature::MISFIT_PERCENT;
use super::error::{CalibrationError, Warning};
use super::options::{CalibrationOptions, HysteresisMode, MapMode};
use super::report::SegmentReport;
use super::sensors::{self, FittedSensor};
use super::statistics::rms;
use super::sweep::Sweep;
use super::{bend_error, contact, extensions, hysteresis, imu_scale, residuals};
use crate::error::Error;

/// A table and the sensors that it was made of.
pub(super) struct Derived {
    pub table: ArmFile,
    pub sensors: Vec<FittedSensor>,
}

/// Derives everything that a table holds from the rows of a sweep.
pub(super) fn table(
    sweep: &Sweep,
    sessions: &[PathBuf],
    arm: &LoadedTable,
    options: CalibrationOptions,
    warnings: &mut Vec<Warning>,
    progress: &mut dyn Progress,
) -> Result<Derived, Error> {
    let refuse = |source| Error::Calibration { path: sessions.first().cloned().unwrap_or_default(), source };
    let mut table = ArmFile { calibration: None, tuning: None, ..arm.file.clone() };
    // The parameters of version 0.1's observer are those of another filter.
    table.drift = table.drift.filter(|drift| drift.kind != DriftKind::Observer).or_else(|| Some(DriftToml::kalman()));
    let is_paper = table.bias_filter().is_none() && options.maps != MapMode::Curve;
    let of_maps = if is_paper {
        CalibrationOptions { maps: MapMode::Quadratic, hysteresis: HysteresisMode::Never }
    } else {
        options
    };
    let sensors = sensors::fit(sweep, of_maps, warnings).map_err(refuse)?;
    let percent = sweep.tip.rms().unwrap_or(0.0) * 1e5 / table.length_mm();
    if percent > MISFIT_PERCENT {
        return Err(refuse(CalibrationError::TruthMisfit { percent }));
    }
    set_maps(&sensors, &mut table);
    if is_paper {
        hysteresis::set(sweep, &mut table.segments, options.hysteresis);
    }
    if table.bias_filter().is_some() {
        set_errors(sweep, &sensors, &mut table);
    } else {
        let mut named = LoadedTable { file: table, path: arm.path };
        residuals::set_filters(sessions, sweep, &mut named, progress)?;
        table = named.file;
    }
    extensions::set(sweep, &mut table);
    set_contact(sweep, &sensors, &mut table);
    Ok(Derived { table, sensors })
}

/// Sets the maps, and clears the segments' other results of a calibration.
fn set_maps(sensors: &[FittedSensor], table: &mut ArmFile) {
    for (i, segment) in table.segments.iter_mut().enumerate() {
        let of_segment = sensors.iter().filter(|sensor| sensor.segment == i);
        segment.bend = Some(of_segment.map(|sensor| sensor.map.clone()).collect::<Vec<BendToml>>());
        segment.hysteresis.clear();
        (segment.orient, segment.coord) = (None, None);
        (segment.bend_error, segment.imu_scale) = (None, None);
    }
}

/// Sets the error model of the bias filter, and the IMUs' sensitivity.
fn set_errors(sweep: &Sweep, sensors: &[FittedSensor], table: &mut ArmFile) {
    let scales = imu_scale::of(sweep);
    let mut offsets = Vec::new();
    for (i, (segment, scale)) in table.segments.iter_mut().zip(scales).enumerate() {
        let of_segment = sensors.iter().filter(|sensor| sensor.segment == i);
        let of_segment: Vec<_> = of_segment.map(|sensor| &sensor.fitted).collect();
        segment.bend_error = bend_error::of(sweep, i, &of_segment);
        segment.imu_scale = scale;
        offsets.extend(bend_error::session_deviation(sweep, &of_segment));
    }
    if let Some(drift) = table.drift.as_mut().filter(|_| !offsets.is_empty()) {
        drift.offset_deg = bend_error::offset_deg(&offsets);
    }
}

/// Sets the limits of contact detection, unless the arm description has thresholds.
fn set_contact(sweep: &Sweep, sensors: &[FittedSensor], table: &mut ArmFile) {
    let of_segment = |i: usize| sensors.iter().filter(move |sensor| sensor.segment == i).map(|sensor| &sensor.fitted);
    let sensors: Vec<Vec<_>> = (0..table.segments.len()).map(|i| of_segment(i).collect()).collect();
    // Where there are limits of segments too, an earlier calibration has written the thresholds.
    let has_limits = table.contact.is_none() || table.segments.iter().any(|segment| segment.contact.is_some());
    table.contact.get_or_insert_default();
    contact::set(sweep, &sensors, has_limits, table);
}

impl Derived {
    /// The segments' expected errors.
    pub fn segment_reports(&self, sweep: &Sweep) -> Vec<SegmentReport> {
        let report = |(i, segment): (usize, &calibration_tables::SegmentToml)| {
            let sensors: Vec<&FittedSensor> = self.sensors.iter().filter(|sensor| sensor.segment == i).collect();
            let mean = |row: usize| {
                let errors = || sensors.iter().filter_map(|sensor| sensor.fitted.held_back[row]);
                let count = errors().count();
                (count > 0).then(|| errors().sum::<f64>() / count as f64)
            };
            let held_back_rmse_deg = rms((0..sweep.runs.len()).filter_map(mean)).to_degrees();
            let maps = sensors.iter().map(|sensor| (sensor.fitted.kind, sensor.fitted.memory.is_some())).collect();
            let imu_scale = segment.imu_scale;
            (!sensors.is_empty()).then_some(SegmentReport { segment: i + 1, held_back_rmse_deg, maps, imu_scale })
        };
        self.table.segments.iter().enumerate().filter_map(report).collect()
    }
}
