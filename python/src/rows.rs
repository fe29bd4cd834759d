//! Arrays as the rows of a session, each value checked as the cell of a file is.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Phase, SENSORS_PER_SEGMENT, Sample};
use proprio::Help;
use proprio_session::{CsvLayout, ImuForm, Row, SENSOR_NAMES, SessionProblem, Truth};
use pyo3::prelude::*;

use crate::array::floats;
use crate::error::with_help;

/// Latest time that a session may have, s.
const MAX_TIME_S: f64 = 100.0 * 365.25 * 86_400.0;
/// Units of 2⁻³⁰ in 1.
const QUATERNION_ONE: f64 = 1_073_741_824.0;

/// The arrays of a session as Python passes them, each of type `f8`; NaN stands for a missing value.
#[derive(FromPyObject)]
pub struct SessionArrays {
    #[pyo3(item)]
    segments: usize,
    #[pyo3(item)]
    time_s: Vec<u8>,
    /// One byte for each row: the estimator is started before it.
    #[pyo3(item)]
    start: Vec<u8>,
    #[pyo3(item)]
    bend_counts: Vec<u8>,
    /// One byte for each bend sensor: it is wired; empty where only those are that were ever read.
    #[pyo3(item)]
    bend_sensors: Vec<u8>,
    /// Headings, rad; empty where there are quaternions.
    #[pyo3(item)]
    imu_heading_rad: Vec<u8>,
    #[pyo3(item)]
    imu_quaternion: Vec<u8>,
    /// Ends in {W}; empty without truth.
    #[pyo3(item)]
    truth_m: Vec<u8>,
    #[pyo3(item)]
    truth_heading_rad: Vec<u8>,
}

/// The rows of a session, and its columns in a file.
pub struct SessionRows {
    pub rows: Vec<Row>,
    pub layout: CsvLayout,
}

/// A value that no session has, and its place.
struct Fault {
    name: String,
    problem: SessionProblem,
}

impl SessionArrays {
    /// Number of the arm's segments.
    pub const fn segments(&self) -> usize {
        self.segments
    }

    /// The rows, after one at `last_us`.
    ///
    /// # Errors
    /// The exception that names the first value that a session cannot have.
    pub fn rows(&self, py: Python<'_>, last_us: Option<u64>) -> PyResult<SessionRows> {
        if self.segments > MAX_SEGMENTS {
            let text = format!("the arrays have {} segments, expected {MAX_SEGMENTS} at most", self.segments);
            return Err(with_help(py, &text, "give arrays of shape (samples, segments, …)"));
        }
        let columns = Columns::new(self);
        let mut rows: Vec<Row> = Vec::with_capacity(columns.time_s.len());
        for i in 0..columns.time_s.len() {
            let last_us = rows.last().map_or(last_us, |row| Some(row.sample.time_us));
            let row = columns.row(i, last_us).map_err(|Fault { name, problem }| {
                with_help(py, &format!("session arrays, row {i}, {name}: {problem}"), &problem.help())
            })?;
            rows.push(row);
        }
        Ok(SessionRows { rows, layout: columns.layout() })
    }
}

/// The arrays as numbers.
struct Columns<'a> {
    segments: usize,
    time_s: Vec<f64>,
    start: &'a [u8],
    bend_sensors: &'a [u8],
    bend: Vec<f64>,
    heading: Vec<f64>,
    quaternion: Vec<f64>,
    truth: Vec<f64>,
    truth_heading: Vec<f64>,
}

impl<'a> Columns<'a> {
    fn new(arrays: &'a SessionArrays) -> Self {
        Self {
            segments: arrays.segments,
            time_s: floats(&arrays.time_s),
            start: &arrays.start,
            bend_sensors: &arrays.bend_sensors,
            bend: floats(&arrays.bend_counts),
            heading: floats(&arrays.imu_heading_rad),
            quaternion: floats(&arrays.imu_quaternion),
            truth: floats(&arrays.truth_m),
            truth_heading: floats(&arrays.truth_heading_rad),
        }
    }

    /// The columns of a file: bend sensors that are not wired have none.
    fn layout(&self) -> CsvLayout {
        let is_read = |i: usize, place: usize| {
            self.bend.iter().skip(SENSORS_PER_SEGMENT * i + place).step_by(SENSORS_PER_SEGMENT * self.segments)
        };
        let has = |i: usize, place: usize| match self.bend_sensors.get(SENSORS_PER_SEGMENT * i + place) {
            Some(wired) => *wired != 0,
            None => is_read(i, place).any(|counts| !counts.is_nan()),
        };
        CsvLayout {
            bend_sensors: (0..self.segments).map(|i| [has(i, 0), has(i, 1)]).collect(),
            imu: if self.quaternion.is_empty() { ImuForm::Heading } else { ImuForm::Quaternion },
            has_truth: !self.truth.is_empty(),
            has_true_headings: !self.truth_heading.is_empty(),
        }
    }

    fn row(&self, i: usize, last_us: Option<u64>) -> Result<Row, Fault> {
        let time_us = time_us(self.time_s[i], last_us)?;
        let starts = self.start.get(i).is_some_and(|start| *start != 0);
        let mut row = Row { sample: Sample::missing(time_us), truth: [None; MAX_SEGMENTS], starts, board: None };
        for k in 0..self.segments {
            let at = i * self.segments + k;
            for (place, counts) in row.sample.bend[k].iter_mut().enumerate() {
                let value = self.bend[at * SENSORS_PER_SEGMENT + place];
                let name = || format!("bend{}{}", k + 1, SENSOR_NAMES[place]);
                *counts = self::counts(value).map_err(|problem| Fault { name: name(), problem })?;
            }
            row.sample.imu[k] = self.imu(at).map_err(|problem| Fault { name: format!("imu{}", k + 1), problem })?;
            row.truth[k] = self.truth(at).map_err(|problem| Fault { name: format!("truth{}", k + 1), problem })?;
        }
        Ok(row)
    }

    fn imu(&self, at: usize) -> Result<Option<ImuReading>, SessionProblem> {
        if let Some(rad) = self.heading.get(at) {
            return match rad {
                rad if rad.is_nan() => Ok(None),
                rad if rad.is_infinite() => Err(SessionProblem::NotFinite(rad.to_string())),
                rad => Ok(Some(ImuReading::Heading(Phase::from_rad(*rad)))),
            };
        }
        let Some([w, x, y, z]) = self.quaternion.get(4 * at..4 * at + 4) else { return Ok(None) };
        let norm = (w * w + x * x + y * y + z * z).sqrt();
        match [w, x, y, z].iter().filter(|part| part.is_nan()).count() {
            4 => Ok(None),
            0 if (norm - 1.0).abs() <= 0.01 => {
                Ok(Some(ImuReading::Quaternion([w, x, y, z].map(|part| (part * QUATERNION_ONE).round() as i32))))
            }
            0 => Err(SessionProblem::NotUnit(norm)),
            _ => Err(SessionProblem::PartialQuaternion),
        }
    }

    fn truth(&self, at: usize) -> Result<Option<Truth>, SessionProblem> {
        let Some([x_m, y_m]) = self.truth.get(2 * at..2 * at + 2) else { return Ok(None) };
        let heading_rad = self.truth_heading.get(at).copied();
        let parts = [Some(*x_m), Some(*y_m), heading_rad];
        match parts.iter().flatten().filter(|part| part.is_nan()).count() {
            0 => Ok(Some(Truth { x_m: *x_m, y_m: *y_m, heading_rad })),
            missing if missing == parts.iter().flatten().count() => Ok(None),
            _ => Err(SessionProblem::PartialTruth),
        }
    }
}

fn time_us(time_s: f64, last_us: Option<u64>) -> Result<u64, Fault> {
    let fault = |problem| Fault { name: "time_s".to_owned(), problem };
    if !(0.0..=MAX_TIME_S).contains(&time_s) {
        return Err(fault(SessionProblem::Time(time_s.to_string())));
    }
    let time_us = (time_s * 1e6).round() as u64;
    match last_us.filter(|last_us| *last_us > time_us) {
        Some(last_us) => Err(fault(SessionProblem::Backwards { from_s: last_us as f64 / 1e6, to_s: time_s })),
        None => Ok(time_us),
    }
}

fn counts(value: f64) -> Result<Option<u16>, SessionProblem> {
    match value {
        value if value.is_nan() => Ok(None),
        value if value.fract() == 0.0 && (0.0..=4095.0).contains(&value) => Ok(Some(value as u16)),
        value => Err(SessionProblem::Counts(value.to_string())),
    }
}
