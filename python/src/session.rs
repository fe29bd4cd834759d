//! Sessions as arrays, and arrays as sessions.

use std::path::{Path, PathBuf};

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Phase};
use proprio_session::{Error, Existing, Header, OutputFile, RequiredColumns, Row, SessionReader};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Arrays, Values};
use crate::error::exception;
use crate::rows::{SessionArrays, SessionRows};

/// Units of 2⁻³⁰ in 1, and of 2⁻²⁶.
const QUATERNION_ONE: f64 = 1_073_741_824.0;
const BOARD_ONE: f64 = 67_108_864.0;

/// Truth of a session, row by row.
#[derive(Debug)]
pub struct Truths {
    segments: usize,
    end_m: Vec<f64>,
    heading_rad: Vec<f64>,
    is_any: bool,
    has_headings: bool,
}

impl Truths {
    /// No truth yet, of an arm of some segments.
    pub fn new(segments: usize) -> Self {
        Self { segments, end_m: Vec::new(), heading_rad: Vec::new(), is_any: false, has_headings: false }
    }

    /// Adds a row.
    pub fn add(&mut self, row: &Row) {
        for truth in &row.truth[..self.segments] {
            self.end_m.extend(truth.map_or([f64::NAN; 2], |truth| [truth.x_m, truth.y_m]));
            let heading = truth.and_then(|truth| truth.heading_rad);
            self.heading_rad.push(heading.unwrap_or(f64::NAN));
            self.is_any |= truth.is_some();
            self.has_headings |= heading.is_some();
        }
    }

    /// Adds the arrays of a session with truth.
    pub fn add_to(self, arrays: &mut Arrays) {
        if self.is_any {
            arrays.add("truth_m", Values::Float(self.end_m), &[self.segments, 2]);
        }
        if self.has_headings {
            arrays.add("truth_heading_rad", Values::Float(self.heading_rad), &[self.segments]);
        }
    }
}

/// Readings of a session, row by row.
struct Readings {
    segments: usize,
    time_s: Vec<f64>,
    start: Vec<bool>,
    bend_counts: Vec<f64>,
    imu_heading_rad: Vec<f64>,
    imu_quaternion: Vec<f64>,
    has_quaternions: bool,
    truths: Truths,
}

impl Readings {
    fn new(segments: usize) -> Self {
        Self {
            segments,
            time_s: Vec::new(),
            start: Vec::new(),
            bend_counts: Vec::new(),
            imu_heading_rad: Vec::new(),
            imu_quaternion: Vec::new(),
            has_quaternions: false,
            truths: Truths::new(segments),
        }
    }

    fn add(&mut self, row: &Row) {
        self.time_s.push(row.sample.time_us as f64 / 1e6);
        self.start.push(row.starts);
        let counts = row.sample.bend[..self.segments].iter().flatten();
        self.bend_counts.extend(counts.map(|counts| counts.map_or(f64::NAN, f64::from)));
        for imu in &row.sample.imu[..self.segments] {
            let heading = imu.and_then(|reading| reading.heading());
            self.imu_heading_rad.push(heading.map_or(f64::NAN, Phase::rad));
            self.imu_quaternion.extend(match imu {
                Some(ImuReading::Quaternion(parts)) => parts.map(|part| f64::from(part) / QUATERNION_ONE),
                Some(ImuReading::Heading(_)) | None => [f64::NAN; 4],
            });
            self.has_quaternions |= matches!(imu, Some(ImuReading::Quaternion(_)));
        }
        self.truths.add(row);
    }

    fn into_arrays(self) -> Arrays {
        let (mut arrays, n) = (Arrays::default(), self.segments);
        arrays.add("time_s", Values::Float(self.time_s), &[]);
        arrays.add("start", Values::Bool(self.start), &[]);
        arrays.add("bend_counts", Values::Float(self.bend_counts), &[n, 2]);
        arrays.add("imu_heading_rad", Values::Float(self.imu_heading_rad), &[n]);
        if self.has_quaternions {
            arrays.add("imu_quaternion", Values::Float(self.imu_quaternion), &[n, 4]);
        }
        self.truths.add_to(&mut arrays);
        arrays
    }
}

/// A board's own output in a recording, row by row.
struct BoardColumns {
    segments: usize,
    tick: Vec<u32>,
    theta_rad: Vec<f64>,
    end_m: Vec<f64>,
}

impl BoardColumns {
    fn add(&mut self, row: &Row) {
        let Some(board) = &row.board else { return };
        self.tick.push(board.tick);
        for i in 0..self.segments {
            let segment = board.estimate.as_ref().and_then(|estimate| *estimate.segments.get(i)?);
            self.theta_rad.push(segment.map_or(f64::NAN, |of| f64::from(of.theta) / BOARD_ONE));
            self.end_m.extend(segment.map_or([f64::NAN; 2], |of| of.end.map(|part| f64::from(part) / BOARD_ONE)));
        }
    }

    fn add_to(self, arrays: &mut Arrays) {
        if !self.tick.is_empty() {
            arrays.add("board_tick", Values::Tick(self.tick), &[]);
            arrays.add("board_theta_rad", Values::Float(self.theta_rad), &[self.segments]);
            arrays.add("board_end_m", Values::Float(self.end_m), &[self.segments, 2]);
        }
    }
}

/// Reads a session; returns its arrays and the warnings.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<(Bound<'_, PyDict>, Vec<String>)> {
    let (arrays, warnings) = py.detach(|| read_arrays(&path)).map_err(|error| exception(py, error))?;
    Ok((arrays.into_dict(py)?, warnings))
}

fn read_arrays(path: &Path) -> Result<(Arrays, Vec<String>), Error> {
    let header = Header::of(path)?;
    let needs = RequiredColumns { bend: vec![None; header.segments.min(MAX_SEGMENTS)], truth: false };
    let mut reader = SessionReader::open(path, &needs)?;
    let segments = reader.segments().max(1);
    let sensors: Vec<[bool; 2]> = reader.bend_sensors().take(segments).collect();
    let mut readings = Readings::new(segments);
    let mut board = BoardColumns { segments, tick: Vec::new(), theta_rad: Vec::new(), end_m: Vec::new() };
    while let Some(row) = reader.next_row()? {
        if row.is_recorded() {
            readings.add(&row);
            board.add(&row);
        }
    }
    let mut arrays = readings.into_arrays();
    arrays.add("bend_sensors", Values::Bool(sensors.into_iter().flatten().collect()), &[2]);
    board.add_to(&mut arrays);
    let warnings = reader.defects().warnings().map(|warning| format!("{}: {warning}", path.display())).collect();
    Ok((arrays, warnings))
}

/// Writes arrays as a session in CSV.
#[pyfunction]
pub fn write(py: Python<'_>, path: PathBuf, arrays: SessionArrays, replace: bool) -> PyResult<()> {
    let SessionRows { rows, layout } = arrays.rows(py, None)?;
    let existing = if replace { Existing::Replace } else { Existing::Keep };
    let write = || {
        let mut file = OutputFile::create(&path, &[], existing)?;
        layout.write_header(&mut file).map_err(|error| file.error(error))?;
        let mut tare = 0;
        for (i, row) in rows.iter().enumerate() {
            tare += u64::from(row.starts && i > 0);
            layout.write_row(&mut file, row, tare).map_err(|error| file.error(error))?;
        }
        file.finish()
    };
    py.detach(write).map(|_| ()).map_err(|error| exception(py, error))
}
