//! Header of Vicon's CSV export: the section `Objects` (Tracker) or `Segments` (Nexus), the rate, the bodies' names above their
//! first columns, the axes `RX` to `TZ`, and the units. Other sections stand before or behind it.

use csv::StringRecord;

use super::axis::Axis;
use super::error::MotionCaptureProblem;
use super::layout::{Body, Layout, TimeColumn, all, angle_unit, cell, length_unit, rate_hz};
use super::rotation::Rotation;
use crate::shown::shown;

/// First cells of sections.
pub(super) const SECTIONS: [&str; 6] = ["Objects", "Segments", "Trajectories", "Joints", "Devices", "Model Outputs"];
/// What Tracker writes before a name.
const PREFIX: &str = "Global Angle ";
/// Rows of the section's header.
const ROWS: usize = 5;

/// True for the row that begins the section of the bodies.
pub(super) fn is_bodies(row: &StringRecord) -> bool {
    ["Objects", "Segments"].contains(&cell(row, 0))
}

/// True for the last row of the section's header.
pub(super) const fn is_last(rows: &[StringRecord]) -> bool {
    rows.len() == ROWS
}

/// The columns, by the rows of the section's header.
pub(super) fn layout(rows: &[StringRecord]) -> Result<Layout, MotionCaptureProblem> {
    let [_, rate, names, axes, units] = rows else { return Err(MotionCaptureProblem::Header) };
    let starts: Vec<usize> = (0..names.len()).filter(|column| !cell(names, *column).is_empty()).collect();
    let unit_of = |column: usize| cell(units, column);
    let (mut bodies, mut metres) = (Vec::new(), 1e-3);
    for (k, start) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(axes.len());
        let find = |axis: &str| (*start..end).find(|column| cell(axes, *column) == axis);
        let position = all(["TX", "TY", "TZ"].map(find));
        let (Some(position), Some(columns)) = (position, all(["RX", "RY", "RZ"].map(find))) else { continue };
        let rotation = match (find("RW"), columns) {
            (Some(w), [x, y, z]) => Rotation::Quaternion([x, y, z, w]),
            (None, columns) => Rotation::Vector { columns, factor: angle_unit(unit_of(columns[0]))? },
        };
        metres = length_unit(unit_of(position[0]))?;
        let name = cell(names, *start);
        bodies.push(Body { name: shown(name.strip_prefix(PREFIX).unwrap_or(name)), position, rotation });
    }
    Ok(Layout { time: TimeColumn::Frames { column: 0, rate_hz: rate_hz(cell(rate, 0))? }, metres, up: Axis::Z, bodies })
}
