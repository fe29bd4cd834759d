//! Header of Qualisys Track Manager's TSV export of 6D data: rows of a key and its values, and a row of columns that begins with
//! `Frame`; each body has its place in mm, Euler angles, a residual and the rotation matrix, `Rot[0]` to `Rot[8]`, column by column.

use csv::StringRecord;

use super::axis::Axis;
use super::error::MotionCaptureProblem;
use super::layout::{Body, Layout, TimeColumn, all, cell, rate_hz, value_of};
use super::rotation::Rotation;
use crate::shown::shown;

/// First cell of an export.
pub(super) const BEGIN: &str = "NO_OF_FRAMES";

/// True for the last row of the header.
pub(super) fn is_last(row: &StringRecord) -> bool {
    cell(row, 0) == "Frame"
}

/// The columns, by the rows of the header.
pub(super) fn layout(rows: &[StringRecord]) -> Result<Layout, MotionCaptureProblem> {
    let [keys @ .., columns] = rows else { return Err(MotionCaptureProblem::Header) };
    let names = keys.iter().find(|row| cell(row, 0) == "BODY_NAMES").ok_or(MotionCaptureProblem::NoBodies)?;
    let names = names.iter().skip(1).map(str::trim).filter(|name| !name.is_empty());
    // The first column of each body has its name in front of the X.
    let is_start = |column: &usize| cell(columns, *column).rsplit(' ').next() == Some("X");
    let starts: Vec<usize> = (0..columns.len()).filter(is_start).collect();
    let body = |(k, name): (usize, &str)| {
        let start = *starts.get(k)?;
        let end = starts.get(k + 1).copied().unwrap_or(columns.len());
        let find = |axis: &str| (start..end).find(|column| cell(columns, *column) == axis);
        let position = all([Some(start), find("Y"), find("Z")])?;
        let matrix = all(std::array::from_fn::<_, 9, _>(|part| find(&format!("Rot[{part}]"))))?;
        Some(Body { name: shown(name), position, rotation: Rotation::Matrix(matrix) })
    };
    let time = (0..columns.len()).find(|column| cell(columns, *column) == "Time");
    let rate = keys.iter().find_map(|row| value_of(row, "FREQUENCY"));
    let time = match (time, rate) {
        (Some(column), _) => TimeColumn::Seconds(column),
        (None, Some(rate)) => TimeColumn::Frames { column: 0, rate_hz: rate_hz(rate)? },
        (None, None) => return Err(MotionCaptureProblem::Header),
    };
    Ok(Layout { time, metres: 1e-3, up: Axis::Z, bodies: names.enumerate().filter_map(body).collect() })
}
