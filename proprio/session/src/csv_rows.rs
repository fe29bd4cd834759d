//! The rows of a session as CSV.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Sample};

use crate::column_names::is_truth;
use crate::columns::{Column, Columns, ImuColumn};
use crate::csv_file::{CsvFile, first_empty};
use crate::{RequiredColumns, Row, SessionError, SessionProblem, cell};

/// A CSV file that is read row by row.
pub(crate) struct CsvRows {
    file: CsvFile,
    columns: Columns,
    last_time_us: u64,
    has_started: bool,
    last_tare: Option<u64>,
}

impl CsvRows {
    /// Finds the columns.
    pub fn new(file: CsvFile, needs: &RequiredColumns) -> Result<Self, SessionError> {
        let columns = Columns::find(file.names(), needs).map_err(|problem| file.header_error(problem))?;
        Ok(Self { file, columns, last_time_us: 0, has_started: false, last_tare: None })
    }

    /// Presence of the bend sensors of each segment.
    pub fn bend_sensors(&self) -> Vec<[bool; 2]> {
        self.columns.segments.iter().map(|segment| segment.bend.map(|column| column.is_some())).collect()
    }

    /// The first column of truth, if there is any.
    pub fn truth_column(&self) -> Option<&str> {
        self.file.names().iter().map(String::as_str).find(|name| is_truth(name))
    }

    pub fn ends_with_line(&self) -> bool {
        self.file.ends_with_line()
    }

    /// Position in the file, bytes.
    pub fn position(&self) -> u64 {
        self.file.progress().0
    }

    /// The next row, or `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row>, SessionError> {
        if !self.file.advance()? {
            return Ok(None);
        }
        let time_us = self.file.cell(self.columns.time, cell::time_us)?;
        if time_us < self.last_time_us {
            let (from_s, to_s) = (self.last_time_us as f64 / 1e6, time_us as f64 / 1e6);
            return Err(self.file.cell_error(self.columns.time, SessionProblem::Backwards { from_s, to_s }));
        }
        self.last_time_us = time_us;
        let tare = self.columns.tare.map_or(Ok(None), |column| self.file.cell(column, cell::tare))?;
        let starts = !std::mem::replace(&mut self.has_started, true) || tare != self.last_tare;
        self.last_tare = tare;
        let mut row = Row { sample: Sample::missing(time_us), truth: [None; MAX_SEGMENTS], starts, board: None };
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
