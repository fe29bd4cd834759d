//! Reads a profile: pressures of all regulators over time, one row per point, one column per regulator.

use std::path::Path;

use crate::columns::{Column, PressureColumns};
use crate::csv_file::CsvFile;
use crate::source::SessionFile;
use crate::{SessionError, SessionProblem, cell};

/// The pressures at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct PressurePoint {
    /// Time since the begin, s.
    pub time_s: f64,
    /// Pressure of each regulator over the atmosphere's, Pa.
    pub pressures_pa: Vec<f64>,
}

/// All points of a profile, in the order of time; at least one.
///
/// # Errors
/// [`SessionError`], with the line and the column.
pub fn read_pressures(path: &Path) -> Result<Vec<PressurePoint>, SessionError> {
    let mut file = CsvFile::new(SessionFile::open(path)?)?;
    let columns = PressureColumns::find(file.names()).map_err(|problem| file.header_error(problem))?;
    let mut points: Vec<PressurePoint> = Vec::new();
    while file.advance()? {
        let time_s = file.cell(columns.time, cell::time_us)? as f64 / 1e6;
        if let Some(last) = points.last().filter(|last| time_s < last.time_s) {
            let problem = SessionProblem::Backwards { from_s: last.time_s, to_s: time_s };
            return Err(file.cell_error(columns.time, problem));
        }
        let cells = columns.regulators.iter();
        let pressures_pa = cells
            .map(|&Column { index, factor }| file.cell(index, |text| cell::pressure_pa(text, factor)))
            .collect::<Result<_, _>>()?;
        points.push(PressurePoint { time_s, pressures_pa });
    }
    if points.is_empty() { Err(file.error(SessionProblem::NoMoments)) } else { Ok(points) }
}
