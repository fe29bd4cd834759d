//! Remedies of errors of calibration, tuning and alignment.

use proprio_calibration::TruthError;
use proprio_calibration::align::AlignmentError;
use proprio_calibration::calibrate::CalibrationError;
use proprio_calibration::tune::TuningError;

use super::Help;

impl Help for TruthError {
    fn help(&self) -> String {
        match self {
            Self::Unit(finding) => finding.help(),
            Self::Lengths(_) => {
                "measure the arm and correct length_mm and offset_mm of its description, or the camera's scale".to_owned()
            }
            Self::Wrong { .. } => {
                "correct the markers' reading, or leave the cells of wrong poses empty; `proprio check` lists all faults"
                    .to_owned()
            }
        }
    }
}

impl Help for CalibrationError {
    fn help(&self) -> String {
        match self {
            Self::NoSensors => {
                "write bend = [] in each segment of the arm description, which makes it a table for imu_o".to_owned()
            }
            Self::SensorBAlone { .. } => "a segment's only sensor is called a: rename the column".to_owned(),
            Self::TruthMisfit { .. } => {
                "x is to the right, y along the base, headings clockwise from y: check the axes and the arm's lengths"
                    .to_owned()
            }
            Self::OtherRate { .. } => "record the sweeps of one calibration at the same rate".to_owned(),
            Self::Unseen { .. } | Self::TooFewRows { .. } => {
                "record a longer sweep, with the camera seeing every segment".to_owned()
            }
            Self::SmallSweep { .. } => "sweep every segment through its whole range, in both directions".to_owned(),
            Self::Dead { name, .. } | Self::Unrelated { name, .. } => {
                format!("check its wiring, or remove column {name}_adc to calibrate without it")
            }
            Self::Saturated { name, .. } | Self::NotMonotonic { name, .. } => {
                format!("change its divider or bend the arm less, or remove column {name}_adc")
            }
            Self::Swapped { .. } => "exchange the two wires, or the two columns of the session".to_owned(),
            Self::InvertedImu { .. } => "mount it with z up, or give the heading clockwise positive".to_owned(),
            Self::SameImus { .. } => {
                "check the multiplexer's wires and addresses, and that the program selects a channel for each IMU"
                    .to_owned()
            }
            Self::RadianImu { segment } => {
                format!("write its headings in degrees, or rename the column to imu{segment}_rad")
            }
            Self::SwappedImu { .. } => "exchange the two mux channels, or the two columns".to_owned(),
            Self::UnrelatedImu { .. } => "check its mount, and that camera and IMUs share one clock".to_owned(),
        }
    }
}

impl Help for TuningError {
    fn help(&self) -> String {
        let help = match self {
            Self::NoBendSensors => "use the table as it is: imu_o needs no tuning",
            Self::Still { .. } => {
                "take a session in which the arm moves as in use, and check that the camera follows it"
            }
            Self::TooFewSamples { .. } => "record a longer session, with the camera seeing the tip to the end",
            Self::TruthMisfit { .. } => {
                "x is to the right, y along the base, headings clockwise from y: check the axes and the arm's lengths"
            }
            Self::NotConverged { .. } => {
                "make the table again with `proprio calibrate`, and take a session in which the arm moves as in use"
            }
            Self::NotFinite => "make the table again with `proprio calibrate`",
        };
        help.to_owned()
    }
}

impl Help for AlignmentError {
    fn help(&self) -> String {
        let help = match self {
            Self::NoSensors => "check the sensors' columns; without readings there is nothing to calibrate",
            Self::NoMarkers => "check the markers' numbers in the camera program",
            Self::NoBase => "put the marker where the camera sees it, or remove the base's columns",
            Self::BaseMoved { .. } => "fix base and camera, and record again",
            Self::NotSeenAtRest { .. } | Self::MovedAtRest { .. } => {
                "start the capture while the arm rests in its reference pose with all bodies in sight, or cut what is before"
            }
            Self::NotInReferencePose { .. } => {
                "start the capture while the arm rests in its reference pose; give the bodies from the base to the tip with --bodies, the axis that the plane is seen from with --up, and each body its pivot at the segment's end"
            }
            Self::TooShort { .. } => "record longer, and let the arm move",
            Self::Hidden { .. } => "record longer, with the markers in sight and well lit",
            Self::TooLong { .. } => "remove rows whose time is wrong, or cut the recording",
            Self::Unrelated { .. } => {
                "check that both are of the same run, that they overlap by a minute, and the order of the markers"
            }
            Self::Mirrored { .. } => {
                "headings are clockwise positive, seen from above; see docs/tutorials/your-own-arm.md for the camera's axes"
            }
            Self::Ambiguous { .. } => {
                "the motion repeats itself: move the arm unevenly, or record both from start to end"
            }
            Self::Still => "let the arm move while both record",
            Self::Skewed { .. } | Self::Uneven { .. } => {
                "give each frame the time when it was taken, not its number over the nominal rate"
            }
        };
        help.to_owned()
    }
}
