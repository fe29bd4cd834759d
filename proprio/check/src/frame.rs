//! Readings of a row as angles, which the rules share. An unknown angle is NaN, with which no comparison is true.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{BendSensorConfig, ImuReading, Phase};
use proprio_session::{Error, LoadedTable, Row};

/// Readings of an ADC of 12 bits.
const COUNTS: usize = 4096;

/// Step of a heading from row to row that is a jump, deg, where the bend sensors show less than this share of it.
const JUMP: f64 = 25.0;
const STILL: f64 = 0.4;

/// Angles of a row, deg.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    /// Number of the row, from 1.
    pub row: u64,
    pub time_s: f64,
    pub counts: [[Option<u16>; 2]; MAX_SEGMENTS],
    pub imus: [Option<ImuReading>; MAX_SEGMENTS],
    pub headings: [Option<Phase>; MAX_SEGMENTS],
    /// Bend angle by each sensor.
    pub bend: [[f64; 2]; MAX_SEGMENTS],
    /// Mean of the bend angles of a segment's sensors.
    pub theta: [f64; MAX_SEGMENTS],
    /// Sum of `theta` from the base: heading of a segment's end by the bend sensors.
    pub bend_heading: [f64; MAX_SEGMENTS],
    /// Heading by the IMU as it was read, 0 to 360.
    pub reading: [f64; MAX_SEGMENTS],
    /// Heading by the IMU, unwrapped.
    pub heading: [f64; MAX_SEGMENTS],
    /// The IMU was not read, or its heading has jumped while the bend sensors show no motion.
    pub broken: [bool; MAX_SEGMENTS],
    /// The estimator starts before this row.
    pub starts: bool,
}

/// Bend angle of every reading of one sensor.
type Angles = Box<[f32]>;

/// Converter of rows to frames.
pub(super) struct Decoder {
    is_table: bool,
    maps: Vec<[Option<Angles>; 2]>,
    last: [f64; MAX_SEGMENTS],
    /// Heading by the bend sensors in the row before.
    last_bend: [f64; MAX_SEGMENTS],
    pub frame: Frame,
}

impl Decoder {
    pub fn new(table: &LoadedTable) -> Result<Self, Error> {
        // An arm description has no maps.
        let is_table = table.file.bend_sensors().is_ok();
        let compiled = is_table.then(|| table.compile::<f64>(table.file.rate_hz)).transpose()?;
        let maps = match &compiled {
            Some(compiled) => compiled
                .config()
                .segments
                .iter()
                .map(|segment| segment.bend.each_ref().map(|sensor| sensor.as_ref().map(angles)))
                .collect(),
            None => vec![[None, None]; table.file.segments.len()],
        };
        let unknown = [f64::NAN; MAX_SEGMENTS];
        let frame = Frame {
            row: 0,
            time_s: 0.0,
            counts: [[None; 2]; MAX_SEGMENTS],
            imus: [None; MAX_SEGMENTS],
            headings: [None; MAX_SEGMENTS],
            bend: [[f64::NAN; 2]; MAX_SEGMENTS],
            theta: unknown,
            bend_heading: unknown,
            reading: unknown,
            heading: unknown,
            broken: [false; MAX_SEGMENTS],
            starts: false,
        };
        Ok(Self { is_table, maps, last: [0.0; MAX_SEGMENTS], last_bend: unknown, frame })
    }

    /// Bend angle of every reading of a sensor; `None` without a map.
    pub fn angles(&self, segment: usize, place: usize) -> Option<&[f32]> {
        self.maps[segment][place].as_deref()
    }

    /// True with a table, false with an arm description.
    pub fn has_maps(&self) -> bool {
        self.is_table
    }

    /// Converts the next row.
    pub fn update(&mut self, row: &Row) {
        let Self { maps, last, last_bend, frame, .. } = self;
        frame.row += 1;
        frame.time_s = row.sample.time_us as f64 / 1e6;
        frame.starts = row.starts;
        frame.imus = row.sample.imu;
        let mut sum = 0.0;
        for (i, map) in maps.iter().enumerate() {
            frame.counts[i] = row.sample.bend[i];
            let mut mean = (0.0, 0.0);
            for (place, angles) in map.iter().enumerate() {
                let angles = row.sample.bend[i][place].zip(angles.as_ref());
                let angle = angles.map_or(f64::NAN, |(counts, angles)| f64::from(angles[usize::from(counts)]));
                frame.bend[i][place] = angle;
                if !angle.is_nan() {
                    mean = (mean.0 + angle, mean.1 + 1.0);
                }
            }
            // 0 / 0 is NaN.
            frame.theta[i] = mean.0 / mean.1;
            sum += frame.theta[i];
            frame.bend_heading[i] = sum;
            frame.headings[i] = row.sample.imu[i].and_then(|reading| reading.heading());
            let reading = frame.headings[i].map_or(f64::NAN, |heading| heading.rad().to_degrees());
            frame.reading[i] = reading.rem_euclid(360.0);
            let step = wrapped(reading - last[i]);
            let bend_step = std::mem::replace(&mut last_bend[i], sum) - sum;
            frame.broken[i] = step.is_nan() || step.abs() > JUMP && bend_step.abs() < STILL * step.abs();
            if !step.is_nan() {
                last[i] += step;
            }
            frame.heading[i] = if reading.is_nan() { reading } else { last[i] };
        }
    }
}

/// Bend angle of every reading of a sensor.
fn angles(sensor: &BendSensorConfig<f64>) -> Angles {
    let angle = |counts: usize| sensor.map.angle(counts as u16).map_or(f32::NAN, |angle| angle.to_degrees() as f32);
    (0..COUNTS).map(angle).collect()
}

/// An angle within ±180°.
pub(super) fn wrapped(degrees: f64) -> f64 {
    if degrees.abs() < 180.0 {
        return degrees;
    }
    degrees - 360.0 * (degrees / 360.0).round()
}

/// Bend angle of segment `i` by headings of the segments' ends; the base's heading is 0.
pub(super) fn difference(headings: &[f64; MAX_SEGMENTS], i: usize) -> f64 {
    headings[i] - if i == 0 { 0.0 } else { headings[i - 1] }
}
