//! The calibration session, column by column.

use std::path::Path;

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::{HeadingTracker, ImuReading, Phase, SENSORS_PER_SEGMENT, SegmentConfig, Turns};

use super::curvature::{constant_curvature_error, end_error, geometry};
use super::error::{CalibrationError, Warning};
use crate::error::Error;
use crate::progress::Progress;
use crate::session::{Needs, Problem, Row, SENSOR_NAMES, SessionError, SessionReader};

/// Bending that a quadratic can be fitted to at all, degrees.
const LEAST_RANGE_DEG: f64 = 10.0;
/// Bending that a good sweep goes beyond, degrees.
const GOOD_RANGE_DEG: f64 = 45.0;
/// Squared correlation from which on two segments are coupled: a sensor's error is a few percent of its signal.
const COUPLED: f64 = 0.98;
/// Rows that a fit needs at least.
pub(super) const LEAST_ROWS: usize = 50;

/// Readings of one bend sensor.
pub(super) struct SensorColumn {
    /// Such as `bend3b`.
    pub name: String,
    /// The segment, from 0.
    pub segment: usize,
    /// 0 for a, 1 for b.
    pub place: usize,
    pub counts: Vec<Option<u16>>,
}

/// Readings and truth of a session; all columns have one value a row.
pub(super) struct Sweep {
    pub rate_hz: f64,
    /// Time of each row, µs, from its own session's zero.
    pub time_us: Vec<u64>,
    pub ends_with_line: bool,
    /// In which run of the estimator each row is: where a new one starts, headings have a new zero and plays are at rest.
    pub runs: Vec<u32>,
    /// True bend angle of each segment, rad.
    pub theta: Vec<Vec<Option<f64>>>,
    /// True heading of each segment's end, unwrapped, rad.
    pub heading: Vec<Vec<Option<f64>>>,
    /// Unwrapped heading of each IMU, rad; its zero is the run's own.
    pub imu: Vec<Vec<Option<f64>>>,
    pub sensors: Vec<SensorColumn>,
    /// Error of constant curvature at each segment's end in its own frame, of both coordinates.
    pub ends: Vec<MeanSquare>,
    /// Distance of the tip from the chain of the true bend angles.
    pub tip: MeanSquare,
    segments: Vec<SegmentConfig<f64>>,
}

/// Mean square of lengths.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MeanSquare {
    sum: f64,
    count: f64,
}

/// Two segments that bend alike.
pub(super) struct Coupling {
    /// Number of the earlier, from 1.
    pub first: usize,
    /// Number of the later.
    pub second: usize,
    /// θ of the later over that of the earlier.
    pub ratio: f64,
}

/// Headings come within one turn, from cameras as from IMUs.
struct Unwrap {
    imu: [HeadingTracker<f64>; MAX_SEGMENTS],
    truth: [HeadingTracker<f64>; MAX_SEGMENTS],
}

impl Sweep {
    pub fn read(session: &Path, arm: &ArmFile) -> Result<Self, Error> {
        let mut reader = SessionReader::open(session, &Needs::of_calibration(arm))?;
        if !reader.is_regular_file() {
            let path = session.to_owned();
            return Err(SessionError { path, line: None, column: None, problem: Problem::NotAFile }.into());
        }
        let n = arm.segments.len();
        let refuse = |source| Error::Calibration { path: session.to_owned(), source };
        let mut sweep = Self {
            rate_hz: reader.rate_hz(arm.rate_hz),
            time_us: Vec::new(),
            ends_with_line: reader.ends_with_line(),
            runs: Vec::new(),
            theta: vec![Vec::new(); n],
            heading: vec![Vec::new(); n],
            imu: vec![Vec::new(); n],
            sensors: sensor_columns(&reader).map_err(refuse)?,
            ends: vec![MeanSquare::default(); n],
            tip: MeanSquare::default(),
            segments: arm.segments.iter().map(geometry).collect(),
        };
        let unread = [HeadingTracker::new(0, Turns::ZERO); MAX_SEGMENTS];
        let mut unwrap = Unwrap { imu: unread, truth: unread };
        let mut progress = Progress::new(format!("reading {}", session.display()), reader.progress().1);
        while let Some(row) = reader.next_row()? {
            sweep.push(&row, &mut unwrap);
            progress.set(reader.progress().0);
        }
        Ok(sweep)
    }

    fn push(&mut self, row: &Row, unwrap: &mut Unwrap) {
        self.runs.push(self.runs.last().copied().unwrap_or_default() + u32::from(row.starts));
        self.time_us.push(row.sample.time_us);
        self.push_shape(row);
        for i in 0..self.theta.len() {
            self.theta[i].push(row.true_theta(i));
            let truth = row.truth[i].and_then(|pose| pose.heading_rad).map(Phase::from_rad);
            self.heading[i].push(unwrap.truth[i].read(truth).map(Turns::rad));
            let imu = row.sample.imu[i].as_ref().and_then(ImuReading::heading);
            self.imu[i].push(unwrap.imu[i].read(imu).map(Turns::rad));
        }
        for sensor in &mut self.sensors {
            sensor.counts.push(row.sample.bend[sensor.segment][sensor.place]);
        }
    }

    /// Compares the true ends with constant curvature.
    fn push_shape(&mut self, row: &Row) {
        self.tip.extend(constant_curvature_error(row, &self.segments));
        for (i, segment) in self.segments.iter().enumerate() {
            let error = end_error(row, i, segment);
            self.ends[i].extend(error.into_iter().flat_map(|error| [error.x, error.y]));
        }
    }

    /// Whether every segment bends far enough.
    pub fn check_range(&self) -> Result<Vec<Warning>, CalibrationError> {
        let mut warnings = Vec::new();
        for (i, theta) in self.theta.iter().enumerate() {
            let known = theta.iter().flatten().count();
            if known < LEAST_ROWS {
                return Err(CalibrationError::Unseen { segment: i + 1, found: known, least: LEAST_ROWS });
            }
            let [lo, hi] = range(theta.iter().flatten().copied());
            let range_deg = (hi - lo).to_degrees();
            if range_deg < LEAST_RANGE_DEG {
                return Err(CalibrationError::SmallSweep { segment: i + 1, range_deg, least_deg: LEAST_RANGE_DEG });
            }
            if range_deg < GOOD_RANGE_DEG {
                warnings.push(Warning::NarrowSweep { segment: i + 1, range_deg });
            }
        }
        let coupled = self.coupled();
        let pairs: Vec<_> = coupled.iter().map(|pair| (pair.first, pair.second)).collect();
        warnings.extend((!pairs.is_empty()).then_some(Warning::Alike(pairs)));
        warnings.extend((!self.ends_with_line).then_some(Warning::LastLine));
        Ok(warnings)
    }

    /// Pairs of segments whose bend angles are the same but for a factor.
    pub fn coupled(&self) -> Vec<Coupling> {
        let n = self.theta.len();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        let coupling = |(i, j): (usize, usize)| {
            let both = self.theta[i].iter().zip(&self.theta[j]).filter_map(|(a, b)| a.zip(*b));
            let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
            for (a, b) in both {
                (aa, ab, bb) = (aa + a * a, ab + a * b, bb + b * b);
            }
            (ab * ab > COUPLED * aa * bb).then(|| Coupling { first: i + 1, second: j + 1, ratio: ab / aa })
        };
        pairs.filter_map(coupling).collect()
    }
}

impl MeanSquare {
    fn extend(&mut self, values: impl IntoIterator<Item = f64>) {
        for value in values {
            self.sum += value * value;
            self.count += 1.0;
        }
    }

    /// Root mean square; `None` of no values.
    pub fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.sum / self.count).sqrt())
    }
}

fn sensor_columns(reader: &SessionReader) -> Result<Vec<SensorColumn>, CalibrationError> {
    let mut columns = Vec::new();
    for (segment, present) in reader.bend_sensors().enumerate() {
        if present == [false, true] {
            return Err(CalibrationError::SensorBAlone { segment: segment + 1 });
        }
        for place in (0..SENSORS_PER_SEGMENT).filter(|place| present[*place]) {
            let name = format!("bend{}{}", segment + 1, SENSOR_NAMES[place]);
            columns.push(SensorColumn { name, segment, place, counts: Vec::new() });
        }
    }
    if columns.is_empty() { Err(CalibrationError::NoSensors) } else { Ok(columns) }
}

/// The smallest and the largest value.
pub(super) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], value| [lo.min(value), hi.max(value)])
}
