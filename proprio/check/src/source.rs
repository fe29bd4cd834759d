//! Sources of findings: sensors, times, truth.

use std::fmt;

use proprio_session::SENSOR_NAMES;
use serde::Serialize;

/// The source that a finding is about; segments from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// The time stamps.
    Time,
    /// A bend sensor: its segment, and its place (0 is `a`, 1 is `b`).
    Bend {
        /// Segment.
        segment: usize,
        /// Place.
        place: usize,
    },
    /// The bend sensors of two segments.
    TwoBends {
        /// The first segment.
        segment: usize,
        /// The second segment.
        other: usize,
    },
    /// A bend sensor of each of two segments: their places as in [`Self::Bend`].
    TwoPlugs {
        /// The segments.
        segments: [usize; 2],
        /// The places.
        places: [usize; 2],
    },
    /// Both bend sensors of a segment.
    Twins {
        /// Segment.
        segment: usize,
    },
    /// The IMU or the bend sensors of a segment, which cannot be told apart at the tip.
    ImuOrBend {
        /// Segment.
        segment: usize,
    },
    /// All bend sensors.
    AllBend,
    /// The IMU at a segment's end.
    Imu {
        /// Segment.
        segment: usize,
    },
    /// Two IMUs.
    TwoImus {
        /// Segment of the first.
        segment: usize,
        /// Segment of the second.
        other: usize,
    },
    /// All IMUs.
    AllImus,
    /// All bend sensors and IMUs.
    AllSensors,
    /// The arm as a whole.
    Arm,
    /// The truth of a segment's end.
    Truth {
        /// Segment.
        segment: usize,
    },
    /// The truth of two segments' ends.
    TwoTruths {
        /// The first segment.
        segment: usize,
        /// The second segment.
        other: usize,
    },
    /// The truth of all segments.
    AllTruth,
}

impl Source {
    /// True for findings about the truth.
    #[must_use]
    pub const fn is_truth(&self) -> bool {
        matches!(self, Self::Truth { .. } | Self::TwoTruths { .. } | Self::AllTruth)
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time => f.write_str("time_s"),
            Self::Bend { segment, place } => write!(f, "bend{segment}{}", SENSOR_NAMES[*place]),
            Self::TwoPlugs { segments: [segment, other], places: [place, of] } => {
                write!(f, "bend{segment}{} and bend{other}{}", SENSOR_NAMES[*place], SENSOR_NAMES[*of])
            }
            Self::TwoBends { segment, other } => write!(f, "bend{segment} and bend{other}"),
            Self::Twins { segment } => write!(f, "bend{segment}a and bend{segment}b"),
            Self::ImuOrBend { segment } => write!(f, "imu{segment} or bend{segment}"),
            Self::AllBend => f.write_str("all bend sensors"),
            Self::Imu { segment } => write!(f, "imu{segment}"),
            Self::TwoImus { segment, other } => write!(f, "imu{segment} and imu{other}"),
            Self::AllImus => f.write_str("all IMUs"),
            Self::AllSensors => f.write_str("all sensors"),
            Self::Arm => f.write_str("arm"),
            Self::Truth { segment } => write!(f, "truth{segment}"),
            Self::TwoTruths { segment, other } => write!(f, "truth{segment} and truth{other}"),
            Self::AllTruth => f.write_str("truth"),
        }
    }
}

impl Serialize for Source {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
