//! Motion in two recordings: pairs of a sensor's and the camera's column that follow the same motion.

use super::signal::Signal;

/// A sensor and the camera's column of the same motion.
pub struct Pair {
    /// The sensor's column.
    pub sensor: Signal,
    /// Index of the camera's column.
    pub camera: usize,
}

/// The motion in both recordings. Times are since the first row and the first frame.
pub struct Motion {
    /// The pairs.
    pub pairs: Vec<Pair>,
    /// The camera's columns.
    pub cameras: Vec<Signal>,
    /// Kind of the sensors.
    pub by: ComparedSensors,
}

/// Sensors that are compared with the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparedSensors {
    /// IMUs, whose headings must follow those of the segments' ends.
    Imus,
    /// Bend sensors, of unknown sign. Each of them has a lag of its own.
    Bend,
}

impl ComparedSensors {
    /// Smallest correlation of good sensors.
    #[must_use]
    pub const fn least_correlation(self) -> f64 {
        match self {
            Self::Imus => 0.95,
            Self::Bend => 0.9,
        }
    }

    /// Largest scatter of the windows' lags that sensors explain, s: more is an uneven clock.
    #[must_use]
    pub const fn most_residual_s(self) -> f64 {
        match self {
            Self::Imus => 0.02,
            Self::Bend => 0.1,
        }
    }
}
