//! Reports about the fits of a calibration.

use super::options::MapKind;

/// Fit of one bend sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorReport {
    /// The sensor, such as `bend3b`.
    pub name: String,
    /// Number of rows that were fitted.
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
    /// Map of each sensor; true where it has a memory.
    pub maps: Vec<(MapKind, bool)>,
    /// Sensitivity of the segment's IMU, where the table has it.
    pub imu_scale: Option<f64>,
}
