//! Header of OptiTrack Motive's CSV export: a row of keys and values, rows of each column's type, name, (id, parent,) and kind, and
//! a row of axes that begins with `Frame,Time (Seconds)`. Positions and rotations are those of the rigid bodies.

use csv::StringRecord;

use super::axis::Axis;
use super::error::MotionCaptureProblem;
use super::layout::{Body, Layout, TimeColumn, all, cell, length_unit, value_of};
use super::rotation::Rotation;
use crate::shown::shown;

/// First cell of an export.
pub(super) const BEGIN: &str = "Format Version";

/// True for the last row of the header.
pub(super) fn is_last(row: &StringRecord) -> bool {
    cell(row, 0).eq_ignore_ascii_case("Frame")
}

/// Form of the rotations.
enum Form {
    Quaternion,
    Euler([Axis; 3]),
}

/// The columns, by the rows of the header.
pub(super) fn layout(rows: &[StringRecord]) -> Result<Layout, MotionCaptureProblem> {
    let [keys, of_columns @ .., kinds, axes] = rows else { return Err(MotionCaptureProblem::Header) };
    let is_body = |row: &StringRecord| row.iter().any(|cell| cell.trim() == "Rigid Body");
    let types = of_columns.iter().position(is_body).ok_or(MotionCaptureProblem::NoBodies)?;
    let (types, names) = (&of_columns[types], of_columns.get(types + 1).ok_or(MotionCaptureProblem::Header)?);
    let form = form(value_of(keys, "Rotation Type").unwrap_or("Quaternion"))?;

    let columns = (0..types.len()).filter(|column| cell(types, *column) == "Rigid Body");
    let mut bodies: Vec<(&str, Vec<usize>)> = Vec::new();
    for column in columns {
        let name = cell(names, column).trim_matches('"');
        match bodies.iter_mut().find(|(of, _)| *of == name) {
            Some((_, columns)) => columns.push(column),
            None => bodies.push((name, vec![column])),
        }
    }
    let body = |(name, columns): (&str, Vec<usize>)| {
        let find = |kind: &str, axis: &str| {
            columns.iter().copied().find(|column| cell(kinds, *column) == kind && cell(axes, *column) == axis)
        };
        let position = all(["X", "Y", "Z"].map(|axis| find("Position", axis)))?;
        let rotation = match form {
            Form::Quaternion => Rotation::Quaternion(all(["X", "Y", "Z", "W"].map(|axis| find("Rotation", axis)))?),
            Form::Euler(order) => {
                let columns = all(order.map(|axis| find("Rotation", ["X", "Y", "Z"][axis.index()])))?;
                Rotation::Euler { columns, order, factor: std::f64::consts::PI / 180.0 }
            }
        };
        Some(Body { name: shown(name), position, rotation })
    };
    let time =
        (0..axes.len()).find(|column| cell(axes, *column).starts_with("Time (")).ok_or(MotionCaptureProblem::Header)?;
    Ok(Layout {
        time: TimeColumn::Seconds(time),
        metres: length_unit(value_of(keys, "Length Units").unwrap_or("Meters"))?,
        up: Axis::Y,
        bodies: bodies.into_iter().filter_map(body).collect(),
    })
}

/// The form of rotations by its name: quaternions, or the order of Euler angles.
fn form(name: &str) -> Result<Form, MotionCaptureProblem> {
    if name.eq_ignore_ascii_case("Quaternion") {
        return Ok(Form::Quaternion);
    }
    let axis = |letter: u8| match letter {
        b'X' => Some(Axis::X),
        b'Y' => Some(Axis::Y),
        b'Z' => Some(Axis::Z),
        _ => None,
    };
    let order = <[u8; 3]>::try_from(name.as_bytes()).ok().map(|letters| letters.map(axis));
    match order {
        Some([Some(first), Some(second), Some(third)]) => Ok(Form::Euler([first, second, third])),
        _ => Err(MotionCaptureProblem::Unit(shown(name))),
    }
}
