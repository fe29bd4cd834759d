//! Remedies of the findings of a session check.

use proprio_check::{Finding, Kind, Source};

use super::Help;

impl Help for Finding {
    fn help(&self) -> String {
        let help = match (self.kind, self.sensor) {
            (Kind::OutsideMap, _) => {
                "check the sensor, its divider and the ADC's reference (3.3 V), and that the table is that of this arm and these plugs"
            }
            (Kind::Counts, _) => {
                "check the ADC's reference and its bits, and that the table is that of this arm; or multiply the counts by the factor's reciprocal"
            }
            (Kind::TenBits, _) => "record with 12 bits (analogReadResolution(12)), or multiply the counts by 4",
            (Kind::Rail, _) => "check the sensor's wires and its divider; leave the cells of a dead sensor empty",
            (Kind::Constant | Kind::Frozen, _) => {
                "restart the sensor or its driver, and check its wires; leave the cells of the repeats empty"
            }
            (Kind::Held, Source::AllSensors) => {
                "check the logger for pauses; leave the cells of the repeats empty, or remove their rows"
            }
            (Kind::Held, _) => "check the driver and its bus for failed readings; leave the cells of the repeats empty",
            (Kind::Zeros, _) => "leave the cell of a failed reading empty",
            (Kind::SameReadings, _) => {
                "both readings are of one multiplexer channel: check the multiplexer's wires and addresses"
            }
            (Kind::Inverted, Source::Bend { .. }) => {
                "exchange the sensor's plug with that of its twin, or turn its divider"
            }
            (Kind::Inverted, _) => "mount the IMU with z up, or write headings clockwise positive, seen from above",
            (Kind::Scale | Kind::Radians, _) => {
                "check the unit: degrees in _deg, radians in _rad, quaternions as w, x, y, z"
            }
            (Kind::Exchanged, Source::TwoBends { .. } | Source::TwoPlugs { .. }) => {
                "exchange the two plugs, or the two columns"
            }
            (Kind::Exchanged, _) => "exchange the two multiplexer channels, or the two columns",
            (Kind::Unrelated, Source::Bend { .. }) => {
                "check the sensor's mount and wires, and that the table is that of this arm"
            }
            (Kind::Unrelated, _) => {
                "check the IMU's mount (z up) and the columns: headings clockwise in degrees, quaternions as w, x, y, z"
            }
            (Kind::QuaternionOrder, _) => "write quaternions as w, x, y, z: the columns are exchanged",
            (Kind::OnItsSide, _) => "mount the IMU level, with z up",
            (Kind::NotAbsolute, _) => {
                "write the seconds at rest in the reference pose into tare.seconds of the table, or headings from the base's direction into the session"
            }
            (Kind::NewZero, Source::TwoImus { .. }) => {
                "exchange the two columns from there on if the plugs were; otherwise check the IMUs' supply, and give these rows another number in column tare, where the arm is straight and at rest"
            }
            (Kind::NewZero, _) => {
                "check the IMU's supply and plug; give the rows from there on another number in column tare, where the arm is straight and at rest"
            }
            (Kind::TareBent | Kind::TareMoves, _) => {
                "begin the session with the arm in its reference pose and at rest for the table's tare.seconds; where it did, take the table of this arm"
            }
            (Kind::TimeUnit, _) => "give time_s in seconds, and check rate_hz of the table",
            (Kind::EqualTimes, _) => "give every row the time of its readings, with decimals enough",
            (Kind::Gaps, _) => "check the logger and its link for losses, or split the session there",
            (Kind::LeavesTwin, _) => {
                "check the sensor's mount and plug, or leave its cells empty from there on; where many do, take the table of this arm"
            }
            (Kind::Drift, Source::Imu { .. }) => {
                "check the IMU's supply, its mode and its mount; leave its cells empty from there on"
            }
            (Kind::Drift, _) => {
                "check the mount of the bend sensors and their supply, and the IMUs; leave the cells of those that drift empty from there on"
            }
            (Kind::TruthZeros | Kind::TruthRepeated, _) => {
                "let the camera program leave the cells of a lost marker empty; calibrate, align and tune leave these rows out"
            }
            (Kind::TruthStaircase, _) => {
                "give the camera's frames with their own times to `proprio align`; calibrate and tune leave the repeats out"
            }
            (Kind::TruthJump, _) => {
                "check the marker's reading, and that headings are not resampled over a whole turn; calibrate, align and tune leave these rows out"
            }
            (Kind::TruthMisplaced, _) => {
                "check the marker's number and its mount; calibrate, align and tune leave these rows out"
            }
            (Kind::TruthExchanged, _) => {
                "check the markers' numbers in the camera program; calibrate, align and tune leave these rows out"
            }
            (Kind::TruthUnit, _) => "write the places in mm in columns of _mm, or in metres in columns of _m",
            (Kind::TruthRadians, _) => "write the headings in degrees, or rename the columns to _heading_rad",
            (Kind::TruthAxes, _) => "x is to the right, y along the base, headings clockwise from y: check the axes",
            (Kind::TruthLengths, _) => {
                "measure the arm and correct length_mm and offset_mm of its description, or the camera's scale"
            }
            (Kind::TruthLag, _) => {
                "remove the columns of truth and join the camera's file again: proprio align SESSION --camera CAMERA --arm ARM -o ALIGNED"
            }
        };
        help.to_owned()
    }
}
