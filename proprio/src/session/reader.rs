//! Reads a session row by row, in memory that does not grow with its length.

use std::collections::VecDeque;
use std::path::Path;

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Sample};

use super::columns::{Column, Columns, ImuColumn, is_truth};
use super::csv_file::{CsvFile, first_empty};
use super::{Needs, Problem, Row, SessionError, cell};

/// Rows at the start whose time stamps tell the sample rate.
const RATE_ROWS: usize = 1001;

/// A session that is being read.
pub struct SessionReader {
    file: CsvFile,
    columns: Columns,
    last_time_us: u64,
    ahead: VecDeque<Row>,
    rate_hz: Option<f64>,
}

impl SessionReader {
    /// Opens a session, finds its columns and reads the first rows.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header and the first rows.
    pub fn open(path: &Path, needs: &Needs) -> Result<Self, SessionError> {
        let file = CsvFile::open(path)?;
        let columns = Columns::find(file.names(), needs).map_err(|problem| file.header_error(problem))?;
        let mut reader = Self { file, columns, last_time_us: 0, ahead: VecDeque::new(), rate_hz: None };
        reader.look_ahead()?;
        Ok(reader)
    }

    fn look_ahead(&mut self) -> Result<(), SessionError> {
        while self.ahead.len() < RATE_ROWS {
            let Some(row) = self.read_row()? else { break };
            self.ahead.push_back(row);
        }
        if self.ahead.is_empty() {
            return Err(self.file.error(Problem::NoSamples));
        }
        let times = self.ahead.iter().map(|row| row.sample.time_us);
        self.rate_hz = rate_hz(times.clone().zip(times.skip(1)).map(|(from, to)| to - from).collect());
        Ok(())
    }

    /// Sample rate: that of the mean step of the first rows without gaps, for jitter and rounded time stamps; where an
    /// arm's `usual_hz`, or up to ten times more or less, is within 1 % of it, that; and `usual_hz` where a single row
    /// does not tell.
    #[must_use]
    pub fn rate_hz(&self, usual_hz: f64) -> f64 {
        let Some(rate_hz) = self.rate_hz else { return usual_hz };
        let ratio = rate_hz / usual_hz;
        let nominal_hz =
            if ratio >= 1.0 { usual_hz * ratio.round().min(10.0) } else { usual_hz / ratio.recip().round().min(10.0) };
        if (rate_hz / nominal_hz - 1.0).abs() < 0.01 { nominal_hz } else { rate_hz }
    }

    /// Whether the session can be read twice, which a pipe cannot.
    #[must_use]
    pub fn is_regular_file(&self) -> bool {
        self.file.is_regular_file()
    }

    /// Which bend sensors of each segment the session has.
    pub fn bend_sensors(&self) -> impl Iterator<Item = [bool; 2]> {
        self.columns.segments.iter().map(|segment| segment.bend.map(|column| column.is_some()))
    }

    /// The first column of truth, if there is any.
    #[must_use]
    pub fn truth_column(&self) -> Option<&str> {
        self.file.names().iter().map(String::as_str).find(|name| is_truth(name))
    }

    /// Whether the last line is ended; if not, its last number may have been cut.
    #[must_use]
    pub fn ends_with_line(&self) -> bool {
        self.file.ends_with_line()
    }

    /// How far the file was read, and its size, in bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        self.file.progress()
    }

    /// The next row, or `None` at the end.
    ///
    /// # Errors
    /// Any [`SessionError`] of a row.
    pub fn next_row(&mut self) -> Result<Option<Row>, SessionError> {
        match self.ahead.pop_front() {
            Some(row) => Ok(Some(row)),
            None => self.read_row(),
        }
    }

    fn read_row(&mut self) -> Result<Option<Row>, SessionError> {
        if !self.file.advance()? {
            return Ok(None);
        }
        let time_us = self.file.cell(self.columns.time, cell::time_us)?;
        if time_us < self.last_time_us {
            let (from_s, to_s) = (self.last_time_us as f64 / 1e6, time_us as f64 / 1e6);
            return Err(self.file.cell_error(self.columns.time, Problem::Backwards { from_s, to_s }));
        }
        self.last_time_us = time_us;
        let mut row = Row { sample: Sample::missing(time_us), truth: [None; MAX_SEGMENTS] };
        let sample = row.sample.bend.iter_mut().zip(&mut row.sample.imu).zip(&mut row.truth);
        for (segment, ((bend, imu), truth)) in self.columns.segments.iter().zip(sample) {
            for (counts, column) in bend.iter_mut().zip(segment.bend) {
                *counts = column.map_or(Ok(None), |column| self.file.cell(column, cell::counts))?;
            }
            *imu = self.imu(segment.imu)?;
            *truth = segment.truth.map_or(Ok(None), |columns| self.file.truth(columns))?;
        }
        Ok(Some(row))
    }

    fn imu(&self, column: ImuColumn) -> Result<Option<ImuReading>, SessionError> {
        match column {
            ImuColumn::Heading(Column { index, factor }) => self.file.cell(index, |text| cell::heading(text, factor)),
            ImuColumn::Quaternion(columns) => {
                let [w, x, y, z] = columns.map(|index| self.file.cell(index, cell::number));
                let parts = [w?, x?, y?, z?];
                cell::quaternion(parts).map_err(|problem| self.file.cell_error(columns[first_empty(&parts)], problem))
            }
        }
    }
}

/// Rate of the mean step, µs, of those that are not over twice the median: rows that were lost are no slower rate.
fn rate_hz(mut steps_us: Vec<u64>) -> Option<f64> {
    steps_us.sort_unstable();
    let median = *steps_us.get(steps_us.len() / 2)?;
    let without_gaps = steps_us.partition_point(|step| *step <= 2 * median);
    let sum = steps_us[..without_gaps].iter().sum::<u64>();
    (sum > 0).then(|| without_gaps as f64 * 1e6 / sum as f64)
}
