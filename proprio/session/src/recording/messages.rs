//! The board's messages as ROS 2 messages.

use std::f64::consts::FRAC_PI_2;

use estimator_core::Q;
use telemetry::{
    BEND_SENSORS, Estimate, Health, Hello, SEGMENTS, Sample, SensorHealth, SensorState, SetPressures, Uncertainty,
};

use super::cdr::{CdrReader, CdrWriter};
use crate::{HostNs, SENSOR_NAMES, Truth};

/// The frame of the arm's base, {W}: x to the right, y along the tangent, z up.
const FRAME: &str = "arm_base";

fn header(stamp: HostNs) -> CdrWriter {
    let mut cdr = CdrWriter::new();
    cdr.u32((stamp.0 / 1_000_000_000) as u32);
    cdr.u32((stamp.0 % 1_000_000_000) as u32);
    cdr.string(FRAME);
    cdr
}

/// `proprio_msgs/msg/Sample`.
pub fn sample(stamp: HostNs, sample: &Sample) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.u32(sample.tick);
    cdr.u64(sample.time_us);
    cdr.u8(sample.tare_epoch);
    cdr.u16(mask(&sample.bend));
    cdr.u8(mask(&sample.imu) as u8);
    sample.bend.iter().for_each(|counts| cdr.u16(counts.unwrap_or_default()));
    sample.imu.iter().flat_map(|quaternion| quaternion.unwrap_or_default()).for_each(|part| cdr.i16(part));
    cdr.into_bytes()
}

/// The sample in a `proprio_msgs/msg/Sample`; `None` where it cannot be decoded.
pub fn read_sample(message: &[u8]) -> Option<Sample> {
    let mut cdr = CdrReader::new(message)?;
    cdr.u32()?;
    cdr.u32()?;
    cdr.string()?;
    let (tick, time_us, tare_epoch) = (cdr.u32()?, cdr.u64()?, cdr.u8()?);
    let (bend_read, imu_read) = (cdr.u16()?, cdr.u8()?);
    let (mut bend, mut imu) = ([None; BEND_SENSORS], [None; SEGMENTS]);
    for (i, place) in bend.iter_mut().enumerate() {
        let counts = cdr.u16()?;
        *place = (bend_read >> i & 1 == 1).then_some(counts);
    }
    for (i, place) in imu.iter_mut().enumerate() {
        let quaternion = [cdr.i16()?, cdr.i16()?, cdr.i16()?, cdr.i16()?];
        *place = (imu_read >> i & 1 == 1).then_some(quaternion);
    }
    Some(Sample { tick, time_us, tare_epoch, bend, imu })
}

/// Bit mask of the values that are present.
fn mask<T>(values: &[Option<T>]) -> u16 {
    values.iter().rev().fold(0, |mask, value| mask << 1 | u16::from(value.is_some()))
}

/// `sensor_msgs/msg/JointState`: bend angles, rad; NaN where not known.
pub fn joint_state(stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.length(SEGMENTS);
    (1..=SEGMENTS).for_each(|i| cdr.string(&format!("theta{i}")));
    cdr.length(SEGMENTS);
    cdr.floats(&estimate.segments.map(|segment| segment.map_or(f64::NAN, |segment| value(segment.theta))));
    // No velocity, no effort.
    cdr.length(0);
    cdr.length(0);
    cdr.into_bytes()
}

/// `geometry_msgs/msg/PoseArray`: the end of each segment, x along its tangent; NaN where not known.
pub fn pose_array(stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.length(SEGMENTS);
    let mut heading = 0.0;
    for segment in estimate.segments {
        let [x, y] = segment.map_or([f64::NAN; 2], |segment| segment.end.map(value));
        heading += segment.map_or(f64::NAN, |segment| value(segment.theta));
        // Headings count clockwise from y, turns about z counter-clockwise from x.
        let (sin, cos) = ((FRAC_PI_2 - heading) / 2.0).sin_cos();
        cdr.floats(&[x, y, 0.0, 0.0, 0.0, sin, cos]);
    }
    cdr.into_bytes()
}

/// `proprio_msgs/msg/Uncertainty`: NaN where not known.
pub fn uncertainty(stamp: HostNs, of: &Uncertainty) -> Vec<u8> {
    let mut cdr = header(stamp);
    for segment in &of.segments {
        cdr.f64(segment.theta_rad2().unwrap_or(f64::NAN));
    }
    for segment in &of.segments {
        cdr.floats(&segment.end_m2().unwrap_or([f64::NAN; 3]));
    }
    of.segments.iter().for_each(|segment| cdr.u8(segment.contact_percent));
    of.segments.iter().for_each(|segment| cdr.u8(segment.in_contact.into()));
    cdr.into_bytes()
}

/// `proprio_msgs/msg/Contact`.
pub fn contact(stamp: HostNs, touched: [bool; SEGMENTS]) -> Vec<u8> {
    let mut cdr = header(stamp);
    for touched in touched {
        cdr.u8(touched.into());
    }
    cdr.into_bytes()
}

/// Converts the estimator's bits to rad or m.
fn value(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64()
}

/// `diagnostic_msgs/msg/DiagnosticArray`: the board, then each sensor.
pub fn diagnostics(stamp: HostNs, health: &Health, hello: Option<&Hello>) -> Vec<u8> {
    let chip = hello.map(|hello| chip_number(&hello.chip)).unwrap_or_default();
    let mut cdr = header(stamp);
    cdr.length(1 + BEND_SENSORS + SEGMENTS);
    board(&mut cdr, health, hello, &chip);
    for (i, sensor) in health.bend.iter().enumerate() {
        sensor_status(&mut cdr, &format!("bend {}{}", i / 2 + 1, SENSOR_NAMES[i % 2]), *sensor, &chip);
    }
    for (i, sensor) in health.imu.iter().enumerate() {
        sensor_status(&mut cdr, &format!("imu {}", i + 1), *sensor, &chip);
    }
    cdr.into_bytes()
}

/// `std_msgs/msg/String`.
pub fn mark(text: &str) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.string(text);
    cdr.into_bytes()
}

/// The text of a `std_msgs/msg/String`; `None` where it cannot be decoded.
pub fn read_mark(message: &[u8]) -> Option<String> {
    CdrReader::new(message)?.string().map(str::to_owned)
}

/// The chip's number in hexadecimal.
pub fn chip_number(chip: &[u8; 16]) -> String {
    format!("{:032x}", u128::from_be_bytes(*chip))
}

fn board(cdr: &mut CdrWriter, health: &Health, hello: Option<&Hello>, chip: &str) {
    let mut values = vec![
        ("tick", health.tick.to_string()),
        ("longest_tick_us", health.max_estimate_latency_us.to_string()),
        ("longest_imu_read_us", health.longest_imu_read_us.to_string()),
        ("load_percent", (f64::from(health.load_permille) / 10.0).to_string()),
        ("overruns", health.overruns.to_string()),
        ("stale_scans", health.stale_scans.to_string()),
        ("dropped_frames", health.dropped_frames.to_string()),
        ("damaged_frames", health.damaged_frames.to_string()),
        ("bus_recoveries", health.bus_recoveries.to_string()),
        ("saturations", health.saturations.to_string()),
        ("actuation", format!("{:?}", health.actuation)),
        ("pressures_pa", health.pressures_pa.map(|pressure| pressure.to_string()).join(" ")),
    ];
    if let Some(hello) = hello {
        values.push(("firmware", hello.firmware.as_str().to_owned()));
        values.push(("arm", hello.arm.as_str().to_owned()));
        values.push(("table", format!("{:08x}", hello.table)));
        values.push(("boot", hello.boot.to_string()));
        values.push(("reset", format!("{:?}", hello.reset)));
    }
    status(cdr, Level::Ok, "board", "running", chip, &values);
}

fn sensor_status(cdr: &mut CdrWriter, name: &str, sensor: SensorHealth, chip: &str) {
    let level = match sensor.state {
        SensorState::Ok => Level::Ok,
        SensorState::Timeout | SensorState::Intermittent => Level::Warn,
        _ => Level::Error,
    };
    status(cdr, level, name, &sensor.state.to_string(), chip, &[("missed", sensor.missed.to_string())]);
}

/// `diagnostic_msgs/msg/DiagnosticStatus`'s levels.
#[derive(Clone, Copy)]
enum Level {
    Ok,
    Warn,
    Error,
}

fn status(cdr: &mut CdrWriter, level: Level, name: &str, message: &str, chip: &str, values: &[(&str, String)]) {
    cdr.u8(level as u8);
    cdr.string(name);
    cdr.string(message);
    cdr.string(chip);
    cdr.length(values.len());
    for (key, value) in values {
        cdr.string(key);
        cdr.string(value);
    }
}

/// `proprio_msgs/msg/SetPoints`.
pub fn set_points(stamp: HostNs, requested: &SetPressures) -> Vec<u8> {
    let mut cdr = header(stamp);
    requested.pressures_pa.iter().for_each(|pressure_pa| cdr.u32(*pressure_pa));
    cdr.u16(requested.valid_ms);
    cdr.into_bytes()
}

/// `proprio_msgs/msg/Truth`.
pub fn truth(stamp: HostNs, ends: &[Option<Truth>]) -> Vec<u8> {
    let mut cdr = header(stamp);
    for part in [|end: &Truth| end.x_m, |end: &Truth| end.y_m, |end: &Truth| end.heading_rad.unwrap_or(f64::NAN)] {
        cdr.length(ends.len());
        let values: Vec<f64> = ends.iter().map(|end| end.as_ref().map_or(f64::NAN, part)).collect();
        cdr.floats(&values);
    }
    cdr.into_bytes()
}

/// The ends in a `proprio_msgs/msg/Truth`; `None` where it cannot be decoded.
pub fn read_truth(message: &[u8]) -> Option<Vec<Option<Truth>>> {
    let mut cdr = CdrReader::new(message)?;
    cdr.u32()?;
    cdr.u32()?;
    cdr.string()?;
    let (xs, ys, headings) = (cdr.floats()?, cdr.floats()?, cdr.floats()?);
    if xs.len() != ys.len() || ys.len() != headings.len() {
        return None;
    }
    let ends = xs.into_iter().zip(ys).zip(headings).map(|((x_m, y_m), heading)| {
        let heading_rad = heading.is_finite().then_some(heading);
        (x_m.is_finite() && y_m.is_finite()).then_some(Truth { x_m, y_m, heading_rad })
    });
    Some(ends.collect())
}

#[cfg(test)]
mod tests {
    use telemetry::{BEND_SENSORS, SEGMENTS, Sample};

    use super::{HostNs, Truth, read_sample, read_truth, sample, truth};

    #[test]
    fn a_sample_is_read_back_to_the_bit() {
        let mut bend = [None; BEND_SENSORS];
        (bend[0], bend[11]) = (Some(4095), Some(0));
        let mut imu = [None; SEGMENTS];
        (imu[0], imu[5]) = (Some([16384, 0, -1, i16::MIN]), Some([0; 4]));
        let sent = Sample { tick: 7, time_us: 1 << 40, tare_epoch: 255, bend, imu };
        assert_eq!(read_sample(&sample(HostNs(5), &sent)), Some(sent));
    }

    #[test]
    fn truth_is_read_back_to_the_bit() {
        let ends = [
            Some(Truth { x_m: 0.1, y_m: -0.2, heading_rad: Some(7.0) }),
            Some(Truth { x_m: 0.1, y_m: -0.2, heading_rad: None }),
            None,
        ];
        assert_eq!(read_truth(&truth(HostNs(5), &ends)), Some(ends.to_vec()));
    }
}
