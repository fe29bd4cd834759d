//! The calibration session, column by column.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::{HeadingTracker, ImuReading, Phase, SENSORS_PER_SEGMENT, SegmentConfig, Turns};
use proprio_check::truth::{LeftOut, geometry};
use proprio_session::{
    FileDefects, Progress, RequiredColumns, Row, SENSOR_NAMES, SessionError, SessionProblem, SessionReader,
};

use super::curvature::{constant_curvature_error, end_error};
use super::error::{CalibrationError, Warning};
use crate::error::Error;
use crate::truth::{self, JudgedTruth};

/// Smallest range of bending to which a quadratic can be fitted, degrees.
pub(crate) const LEAST_RANGE_DEG: f64 = 10.0;
/// Range of bending that a good sweep exceeds, degrees.
pub(crate) const GOOD_RANGE_DEG: f64 = 45.0;
/// Squared correlation from which on two segments are coupled: a sensor's error is a few percent of its signal.
pub(crate) const COUPLED: f64 = 0.98;
/// Largest difference of two sessions' sample rates that count as equal, as a share.
const SAME_RATE: f64 = 0.02;
/// Fewest rows of a fit.
pub(super) const LEAST_ROWS: usize = 50;

/// Readings of one bend sensor.
#[derive(Clone)]
pub(super) struct SensorColumn {
    /// Such as `bend3b`.
    pub name: String,
    /// The segment, from 0.
    pub segment: usize,
    /// 0 for a, 1 for b.
    pub place: usize,
    pub counts: Vec<Option<u16>>,
}

/// Readings and truth of a session; all columns have one value per row.
pub(super) struct Sweep {
    pub rate_hz: f64,
    /// Time of each row, µs, from its own session's zero.
    pub time_us: Vec<u64>,
    /// Defects of each session's file.
    pub defects: Vec<FileDefects>,
    /// Run of the estimator of each row: at a start, headings have a new zero and plays are reset.
    pub runs: Vec<u32>,
    /// The session that each row is of.
    pub sessions: Vec<usize>,
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
    /// The truth of each session.
    pub truth: Vec<JudgedTruth>,
    /// The wrong poses of each session, which are not in the columns.
    pub left_out: Vec<LeftOut>,
    segments: Vec<SegmentConfig<f64>>,
}

/// Mean square of lengths.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MeanSquare {
    sum: f64,
    count: f64,
}

/// Two coupled segments.
pub(super) struct Coupling {
    /// Number of the earlier, from 1.
    pub first: usize,
    /// Number of the later.
    pub second: usize,
}

/// Unwraps headings, which cameras and IMUs give within one turn.
struct Unwrap {
    imu: [HeadingTracker<f64>; MAX_SEGMENTS],
    truth: [HeadingTracker<f64>; MAX_SEGMENTS],
}

impl Sweep {
    /// Reads one sweep or several of the same arm, one after the other.
    pub fn read(sessions: &[PathBuf], arm: &ArmFile, progress: &mut dyn Progress) -> Result<Self, Error> {
        let n = arm.segments.len();
        let mut sweep = Self {
            rate_hz: arm.rate_hz,
            time_us: Vec::new(),
            defects: Vec::new(),
            runs: Vec::new(),
            sessions: Vec::new(),
            theta: vec![Vec::new(); n],
            heading: vec![Vec::new(); n],
            imu: vec![Vec::new(); n],
            sensors: Vec::new(),
            ends: vec![MeanSquare::default(); n],
            tip: MeanSquare::default(),
            truth: Vec::new(),
            left_out: Vec::new(),
            segments: arm.segments.iter().map(geometry).collect(),
        };
        let mut needs = RequiredColumns::of_calibration(arm);
        for (number, session) in sessions.iter().enumerate() {
            sweep.read_one(session, number, arm, &mut needs, progress)?;
        }
        Ok(sweep)
    }

    fn read_one(
        &mut self,
        session: &Path,
        number: usize,
        arm: &ArmFile,
        needs: &mut RequiredColumns,
        progress: &mut dyn Progress,
    ) -> Result<(), Error> {
        let mut reader = SessionReader::open(session, needs)?;
        if !reader.is_regular_file() {
            let path = session.to_owned();
            return Err(SessionError { path, line: None, column: None, problem: SessionProblem::NotAFile }.into());
        }
        let (judged, left_out) = truth::judge(session, arm, needs, progress)?;
        judged.check_lengths()?;
        let refuse = |source| Error::Calibration { path: session.to_owned(), source };
        let rate_hz = reader.rate_hz(arm.rate_hz)?;
        if number == 0 {
            self.rate_hz = rate_hz;
            self.sensors = sensor_columns(&reader).map_err(refuse)?;
            // All sessions must have the sensors of the first one.
            for (count, present) in needs.bend.iter_mut().zip(reader.bend_sensors()) {
                *count = Some(present.into_iter().filter(|present| *present).count());
            }
        } else if (rate_hz / self.rate_hz - 1.0).abs() > SAME_RATE {
            return Err(refuse(CalibrationError::OtherRate { found_hz: rate_hz, expected_hz: self.rate_hz }));
        }
        let unread = [HeadingTracker::new(0, Turns::ZERO); MAX_SEGMENTS];
        let mut unwrap = Unwrap { imu: unread, truth: unread };
        let work = format!("reading {}", session.display());
        let mut rows = 0;
        while let Some(row) = reader.next_row()? {
            self.push(&left_out.without(&row, rows), number, &mut unwrap);
            rows += 1;
            progress.advance(&work, reader.progress());
        }
        self.defects.push(reader.defects());
        self.truth.push(judged);
        self.left_out.push(left_out);
        Ok(())
    }

    fn push(&mut self, row: &Row, session: usize, unwrap: &mut Unwrap) {
        let starts = row.starts || self.sessions.last().is_some_and(|last| *last != session);
        self.runs.push(self.runs.last().copied().unwrap_or_default() + u32::from(starts));
        self.sessions.push(session);
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

    /// The sweep without the last `share` of each session's rows.
    pub fn without_last(&self, share: f64) -> Self {
        let is_kept: Vec<bool> = self.last_rows(share).into_iter().map(|is_last| !is_last).collect();
        let columns = |columns: &[Vec<Option<f64>>]| columns.iter().map(|column| kept(column, &is_kept)).collect();
        let sensor = |sensor: &SensorColumn| SensorColumn { counts: kept(&sensor.counts, &is_kept), ..sensor.clone() };
        Self {
            time_us: kept(&self.time_us, &is_kept),
            defects: Vec::new(),
            runs: kept(&self.runs, &is_kept),
            sessions: kept(&self.sessions, &is_kept),
            theta: columns(&self.theta),
            heading: columns(&self.heading),
            imu: columns(&self.imu),
            sensors: self.sensors.iter().map(sensor).collect(),
            ends: self.ends.clone(),
            truth: self.truth.clone(),
            left_out: self.left_out.clone(),
            segments: self.segments.clone(),
            ..*self
        }
    }

    /// True for each row in the last `share` of its session.
    pub fn last_rows(&self, share: f64) -> Vec<bool> {
        let sessions = self.sessions.chunk_by(|a, b| a == b);
        let is_last = |rows: &[usize]| {
            let first = ((1.0 - share) * rows.len() as f64).round() as usize;
            (0..rows.len()).map(move |row| row >= first)
        };
        sessions.flat_map(is_last).collect()
    }

    /// Compares the true ends with constant curvature.
    fn push_shape(&mut self, row: &Row) {
        self.tip.extend(constant_curvature_error(row, &self.segments));
        for (i, segment) in self.segments.iter().enumerate() {
            let error = end_error(row, i, segment);
            self.ends[i].extend(error.into_iter().flat_map(|error| [error.x, error.y]));
        }
    }

    /// Checks that every segment bends far enough.
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
        warnings.extend((!pairs.is_empty()).then_some(Warning::CoupledSegments(pairs)));
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
            (ab * ab > COUPLED * aa * bb).then(|| Coupling { first: i + 1, second: j + 1 })
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

    /// Root mean square; `None` without values.
    pub fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.sum / self.count).sqrt())
    }
}

/// The rows of a column that are kept.
fn kept<T: Copy>(column: &[T], is_kept: &[bool]) -> Vec<T> {
    column.iter().zip(is_kept).filter(|(_, is_kept)| **is_kept).map(|(value, _)| *value).collect()
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

#[cfg(test)]
impl Sweep {
    /// A session of one segment with one bend sensor.
    pub fn of_sensor(rate_hz: f64, counts: Vec<Option<u16>>, theta: Vec<Option<f64>>, runs: Vec<u32>) -> Self {
        let rows = theta.len();
        Self {
            rate_hz,
            time_us: (0..rows).map(|row| (row as f64 * 1e6 / rate_hz) as u64).collect(),
            defects: Vec::new(),
            runs,
            sessions: vec![0; rows],
            heading: vec![theta.clone()],
            imu: vec![theta.clone()],
            theta: vec![theta],
            sensors: vec![SensorColumn { name: "bend1a".to_owned(), segment: 0, place: 0, counts }],
            ends: vec![MeanSquare::default()],
            tip: MeanSquare::default(),
            truth: Vec::new(),
            left_out: Vec::new(),
            segments: vec![SegmentConfig::uncalibrated(0.1, 0.0)],
        }
    }
}
