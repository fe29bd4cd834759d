//! Sensors that do not follow their segment in a sweep.

use std::fmt;

use proprio_session::SENSOR_NAMES;

/// A sensor that does not follow. Segments count from 1. `Display` has the remedy as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepFault {
    /// A bend sensor whose readings stay while its segment bends.
    BendStays {
        /// The segment.
        segment: usize,
        /// 0 for a, 1 for b.
        place: usize,
    },
    /// A bend sensor that moves otherwise than its segment.
    BendUnrelated {
        /// The segment.
        segment: usize,
        /// 0 for a, 1 for b.
        place: usize,
    },
    /// An IMU whose heading stays while its segment bends.
    ImuStays {
        /// The segment at whose end it sits.
        segment: usize,
    },
    /// An IMU that moves otherwise than the bend sensors on both sides of it.
    ImuUnrelated {
        /// The segment at whose end it sits.
        segment: usize,
    },
    /// A segment whose bend sensors move otherwise than its IMUs, which those of its neighbours follow.
    Segment {
        /// The segment.
        segment: usize,
    },
}

impl fmt::Display for SweepFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BendStays { segment, place } => {
                let name = SENSOR_NAMES[place];
                write!(f, "bend{segment}{name} stays while segment {segment} bends: check its plug and wires")
            }
            Self::BendUnrelated { segment, place } => {
                let name = SENSOR_NAMES[place];
                write!(f, "bend{segment}{name} does not follow segment {segment}: check its mount and its plug")
            }
            Self::ImuStays { segment } => {
                write!(
                    f,
                    "imu{segment} stays while the bend sensors of segment {segment} move: check its plug and mount"
                )
            }
            Self::ImuUnrelated { segment } => {
                write!(f, "imu{segment} does not turn with the bend sensors on both sides of it: check its mount")
            }
            Self::Segment { segment } => write!(
                f,
                "imu{segment} and the bend sensors of segment {segment} do not move together: check the IMU's mount, and \
                 whether the sensors are plugged in as those of another segment"
            ),
        }
    }
}
