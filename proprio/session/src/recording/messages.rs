//! The board's messages as ROS 2 messages.

use std::f64::consts::FRAC_PI_2;

use estimator_core::Q;
use telemetry::{
    BEND_PER_SEGMENT, Estimate, Health, Hello, MAX_BEND_SENSORS, Sample, SensorHealth, SensorState, SetPressures,
    Uncertainty,
};

use super::cdr::{CdrReader, CdrWriter};
use crate::{HostNs, SENSOR_NAMES, Truth, degradations};

/// The frame of the arm's base, {W}: x to the right, y along the tangent, z up.
const FRAME: &str = "arm_base";

/// Segments in every sample of versions before 0.3.
const EARLIER_SEGMENTS: usize = 6;
/// Bend sensors in every sample of versions before 0.3.
const EARLIER_SENSORS: usize = EARLIER_SEGMENTS * BEND_PER_SEGMENT;

/// A message that begins with a `std_msgs/Header`.
fn header(stamp: HostNs) -> CdrWriter {
    let mut cdr = CdrWriter::new();
    write_header(&mut cdr, stamp);
    cdr
}

/// Writes a `std_msgs/Header` in the frame of the arm's base, `arm_base`.
pub fn write_header(cdr: &mut CdrWriter, stamp: HostNs) {
    cdr.u32((stamp.0 / 1_000_000_000) as u32);
    cdr.u32((stamp.0 % 1_000_000_000) as u32);
    cdr.string(FRAME);
}

/// `proprio_msgs/msg/Sample`.
pub fn sample(stamp: HostNs, sample: &Sample) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.u32(sample.tick);
    cdr.u64(sample.time_us);
    cdr.u8(sample.tare_epoch);
    cdr.u16(mask(&sample.bend));
    cdr.u8(mask(&sample.imu) as u8);
    cdr.length(sample.bend.len());
    sample.bend.iter().for_each(|counts| cdr.u16(counts.unwrap_or_default()));
    cdr.length(4 * sample.imu.len());
    sample.imu.iter().flat_map(|quaternion| quaternion.unwrap_or_default()).for_each(|part| cdr.i16(part));
    cdr.into_bytes()
}

/// The sample in a `proprio_msgs/msg/Sample`; `None` where it cannot be decoded.
///
/// Versions before 0.3 have written arrays without their lengths: 78 bytes behind the board's time, where N segments with the
/// lengths have 16 + 12 N.
pub fn read_sample(message: &[u8]) -> Option<Sample> {
    sample_with(message, CdrReader::length).or_else(|| {
        let mut lengths = [EARLIER_SENSORS, 4 * EARLIER_SEGMENTS].into_iter();
        sample_with(message, |_| lengths.next())
    })
}

/// The sample in a message whose two arrays have the lengths that `length` reads.
fn sample_with<'b>(message: &'b [u8], mut length: impl FnMut(&mut CdrReader<'b>) -> Option<usize>) -> Option<Sample> {
    let mut cdr = CdrReader::new(message)?;
    cdr.u32()?;
    cdr.u32()?;
    cdr.string()?;
    let (tick, time_us, tare_epoch) = (cdr.u32()?, cdr.u64()?, cdr.u8()?);
    let (bend_read, imu_read) = (cdr.u16()?, cdr.u8()?);
    let sensors = length(&mut cdr).filter(|sensors| *sensors <= MAX_BEND_SENSORS)?;
    let bend = (0..sensors).map(|i| Some((bend_read >> i & 1 == 1).then_some(cdr.u16()?))).collect::<Option<_>>()?;
    let segments = sensors / BEND_PER_SEGMENT;
    if length(&mut cdr)? != 4 * segments || sensors % BEND_PER_SEGMENT != 0 {
        return None;
    }
    let mut quaternion = || Some([cdr.i16()?, cdr.i16()?, cdr.i16()?, cdr.i16()?]);
    let imu = (0..segments).map(|i| Some((imu_read >> i & 1 == 1).then_some(quaternion()?))).collect::<Option<_>>()?;
    cdr.is_at_end().then_some(Sample { tick, time_us, tare_epoch, bend, imu })
}

/// Bit mask of the values that are present.
fn mask<T>(values: &[Option<T>]) -> u16 {
    values.iter().rev().fold(0, |mask, value| mask << 1 | u16::from(value.is_some()))
}

/// `sensor_msgs/msg/JointState`: bend angles, rad; NaN where not known.
pub fn joint_state(stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
    let segments = estimate.segments.len();
    let mut cdr = header(stamp);
    cdr.length(segments);
    (1..=segments).for_each(|i| cdr.string(&format!("theta{i}")));
    cdr.length(segments);
    for segment in &estimate.segments {
        cdr.f64(segment.map_or(f64::NAN, |segment| value(segment.theta)));
    }
    // No velocity, no effort.
    cdr.length(0);
    cdr.length(0);
    cdr.into_bytes()
}

/// `geometry_msgs/msg/PoseArray`: the end of each segment, x along its tangent; NaN where not known.
pub fn pose_array(stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.length(estimate.segments.len());
    for end in SegmentEnd::all(estimate) {
        cdr.floats(&[end.x_m, end.y_m, 0.0]);
        cdr.floats(&end.quaternion());
    }
    cdr.into_bytes()
}

/// The estimated end of a segment in the frame of the arm's base; NaN where not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentEnd {
    /// Bend angle of the segment, rad.
    pub theta_rad: f64,
    /// Position to the right, m.
    pub x_m: f64,
    /// Position along the base's tangent, m.
    pub y_m: f64,
    /// Heading of the tangent, rad, clockwise from the base's.
    pub heading_rad: f64,
}

impl SegmentEnd {
    /// The ends of all segments, from the base.
    pub fn all(estimate: &Estimate) -> impl Iterator<Item = Self> {
        let mut heading_rad = 0.0;
        estimate.segments.iter().map(move |segment| {
            let [x_m, y_m] = segment.map_or([f64::NAN; 2], |segment| segment.end.map(value));
            let theta_rad = segment.map_or(f64::NAN, |segment| value(segment.theta));
            heading_rad += theta_rad;
            Self { theta_rad, x_m, y_m, heading_rad }
        })
    }

    /// Its orientation x, y, z, w: the x axis is along the tangent.
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        // Headings count clockwise from y, turns about z counter-clockwise from x.
        let (sin, cos) = ((FRAC_PI_2 - self.heading_rad) / 2.0).sin_cos();
        [0.0, 0.0, sin, cos]
    }
}

/// `proprio_msgs/msg/Uncertainty`: NaN where not known.
pub fn uncertainty(stamp: HostNs, of: &Uncertainty) -> Vec<u8> {
    let segments = of.segments.len();
    let mut cdr = header(stamp);
    cdr.length(segments);
    for segment in &of.segments {
        cdr.f64(segment.theta_rad2().unwrap_or(f64::NAN));
    }
    cdr.length(3 * segments);
    for segment in &of.segments {
        cdr.floats(&segment.end_m2().unwrap_or([f64::NAN; 3]));
    }
    cdr.length(segments);
    of.segments.iter().for_each(|segment| cdr.u8(segment.contact_percent));
    cdr.length(segments);
    of.segments.iter().for_each(|segment| cdr.u8(segment.in_contact.into()));
    cdr.into_bytes()
}

/// `proprio_msgs/msg/Contact` of so many segments; bit i of `mask` is the contact of segment i, from 0.
pub fn contact(stamp: HostNs, mask: u8, segments: usize) -> Vec<u8> {
    let mut cdr = header(stamp);
    cdr.length(segments);
    (0..segments).for_each(|i| cdr.u8(mask >> i & 1));
    cdr.into_bytes()
}

/// Converts the estimator's bits to rad or m.
fn value(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64()
}

/// `diagnostic_msgs/msg/DiagnosticArray`: the board, then each sensor that is wired.
pub fn diagnostics(stamp: HostNs, health: &Health, hello: Option<&Hello>) -> Vec<u8> {
    let chip = hello.map(|hello| chip_number(&hello.chip)).unwrap_or_default();
    let bend = health.bend.iter().enumerate();
    let bend = bend.map(|(i, sensor)| (format!("bend {}{}", i / 2 + 1, SENSOR_NAMES[i % 2]), *sensor));
    let imu = (1..).zip(&health.imu).map(|(i, sensor)| (format!("imu {i}"), *sensor));
    let sensors: Vec<_> = bend.chain(imu).filter(|(_, sensor)| sensor.state != SensorState::NotWired).collect();
    let mut cdr = header(stamp);
    cdr.length(1 + sensors.len());
    board(&mut cdr, health, hello, &chip);
    for (name, sensor) in sensors {
        sensor_status(&mut cdr, &name, sensor, &chip);
    }
    cdr.into_bytes()
}

/// `std_msgs/msg/UInt8MultiArray` of received bytes.
pub fn bytes(bytes: &[u8]) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    // No dimension, no offset.
    cdr.length(0);
    cdr.u32(0);
    cdr.bytes(bytes);
    cdr.into_bytes()
}

/// The bytes in a `std_msgs/msg/UInt8MultiArray`; `None` for any other message, as in recordings of version 0.1, which hold the
/// received bytes themselves. A board's bytes do not have this form: eleven of its first twelve bytes are 0, each of which ends a
/// frame.
pub fn read_bytes(message: &[u8]) -> Option<&[u8]> {
    let mut cdr = CdrReader::new(message)?;
    let (dimensions, offset) = (cdr.length()?, cdr.u32()?);
    let bytes = cdr.bytes().filter(|_| dimensions == 0 && offset == 0)?;
    cdr.is_at_end().then_some(bytes)
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
        ("unknown_frames", health.unknown_frames.to_string()),
        ("bus_recoveries", health.bus_recoveries.to_string()),
        ("saturations", health.saturations.to_string()),
        ("actuation", format!("{:?}", health.actuation)),
        ("pressures_pa", health.pressures_pa.iter().map(u32::to_string).collect::<Vec<_>>().join(" ")),
    ];
    if let Some(hello) = hello {
        values.push(("firmware", hello.firmware.as_str().to_owned()));
        values.push(("arm", hello.arm.as_str().to_owned()));
        values.push(("table", format!("{:08x}", hello.table)));
        values.push(("boot", hello.boot.to_string()));
        values.push(("reset", format!("{:?}", hello.reset)));
    }
    let reasons: Vec<String> = degradations(health).collect();
    let (level, message) =
        if reasons.is_empty() { (Level::Ok, "running".to_owned()) } else { (Level::Warn, reasons.join("; ")) };
    status(cdr, level, "board", &message, chip, &values);
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
    cdr.length(requested.pressures_pa.len());
    requested.pressures_pa.iter().for_each(|pressure_pa| cdr.u32(*pressure_pa));
    cdr.u16(requested.valid_ms);
    cdr.into_bytes()
}

/// The pressures in a `proprio_msgs/msg/SetPoints`, Pa; `None` where it cannot be decoded.
pub fn read_set_points(message: &[u8]) -> Option<Vec<u32>> {
    let mut cdr = CdrReader::new(message)?;
    cdr.u32()?;
    cdr.u32()?;
    cdr.string()?;
    let regulators = cdr.length()?;
    let pressures_pa = (0..regulators).map(|_| cdr.u32()).collect::<Option<_>>()?;
    cdr.u16()?;
    cdr.is_at_end().then_some(pressures_pa)
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
    use telemetry::Sample;

    use super::{CdrWriter, HostNs, Truth, bytes, header, read_bytes, read_sample, read_truth, sample, truth};

    /// Readings of so many segments; the first sensor and the last IMU are missing.
    fn sent(segments: u16) -> Sample {
        let bend = (0..2 * segments).map(|i| (i > 0).then_some(4095 - i)).collect();
        let imu = (1..=segments).map(|i| (i < segments).then_some([16_384, i as i16, -1, i16::MIN])).collect();
        Sample { tick: 7, time_us: 1 << 40, tare_epoch: 255, bend, imu }
    }

    #[test]
    fn samples_of_arms_of_any_length_are_read_back_to_the_bit() {
        for segments in 0..=8 {
            let sent = sent(segments);
            assert_eq!(read_sample(&sample(HostNs(5), &sent)), Some(sent));
        }
    }

    #[test]
    fn a_sample_without_lengths_is_one_of_six_segments() {
        let sent = sent(6);
        let mut cdr: CdrWriter = header(HostNs(5));
        cdr.u32(sent.tick);
        cdr.u64(sent.time_us);
        cdr.u8(sent.tare_epoch);
        cdr.u16(0b1111_1111_1110);
        cdr.u8(0b01_1111);
        sent.bend.iter().for_each(|counts| cdr.u16(counts.unwrap_or(0)));
        sent.imu.iter().flat_map(|imu| imu.unwrap_or([0; 4])).for_each(|part| cdr.i16(part));
        assert_eq!(read_sample(&cdr.into_bytes()), Some(sent));
    }

    #[test]
    fn a_sample_that_is_cut_or_longer_is_not_read() {
        let whole = sample(HostNs(5), &sent(3));
        assert!((0..whole.len()).all(|length| read_sample(&whole[..length]).is_none()));
        assert_eq!(read_sample(&[&whole[..], &[0]].concat()), None);
    }

    #[test]
    fn received_bytes_are_read_back_and_those_of_version_0_1_are_told_apart() {
        for received in [&[][..], &[0], &[3, 1, 2, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]] {
            assert_eq!(read_bytes(&bytes(received)), Some(received));
            assert_eq!(read_bytes(received), None);
        }
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
