//! Columns of an export's bodies.

use csv::StringRecord;

use super::axis::Axis;
use super::error::MotionCaptureProblem;
use super::rotation::Rotation;
use crate::shown::shown;

/// Columns of an export, and their units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub time: TimeColumn,
    /// Length unit of positions, m.
    pub metres: f64,
    /// The vertical axis.
    pub up: Axis,
    pub bodies: Vec<Body>,
}

/// Time of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TimeColumn {
    /// Column of the time, s.
    Seconds(usize),
    /// Column of the frame's number, and frames per second.
    Frames { column: usize, rate_hz: f64 },
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub name: String,
    /// Columns of x, y, z.
    pub position: [usize; 3],
    pub rotation: Rotation,
}

impl Layout {
    /// The layout with the bodies of the names, in that order, for an arm of `segments` segments; without names all, in the file's
    /// order.
    pub fn select(mut self, names: &[String], segments: usize) -> Result<Self, MotionCaptureProblem> {
        if self.bodies.is_empty() {
            return Err(MotionCaptureProblem::NoBodies);
        }
        if !names.is_empty() {
            self.bodies = names.iter().map(|name| self.body(name)).collect::<Result<_, _>>()?;
        }
        let found = || self.bodies.iter().map(|body| body.name.clone()).collect();
        if let Some(twice) = (1..self.bodies.len()).find(|i| self.bodies[..*i].contains(&self.bodies[*i])) {
            return Err(MotionCaptureProblem::Twice(self.bodies[twice].name.clone()));
        }
        if ![segments, segments + 1].contains(&self.bodies.len()) {
            return Err(MotionCaptureProblem::Count { found: found(), segments });
        }
        Ok(self)
    }

    /// A body by its name, or by the part of it behind the last colon, in front of which Vicon writes the subject's.
    fn body(&self, name: &str) -> Result<Body, MotionCaptureProblem> {
        let own = |body: &Body| body.name.rsplit(':').next().is_some_and(|own| own.eq_ignore_ascii_case(name));
        let same = |body: &&Body| body.name.eq_ignore_ascii_case(name);
        let body = self.bodies.iter().find(same).or_else(|| self.bodies.iter().find(|body| own(body)));
        body.cloned().ok_or_else(|| MotionCaptureProblem::Unknown {
            name: name.to_owned(),
            found: self.bodies.iter().map(|body| body.name.clone()).collect(),
        })
    }
}

/// A cell of a header, without spaces around it.
pub(super) fn cell(row: &StringRecord, column: usize) -> &str {
    row.get(column).unwrap_or_default().trim()
}

/// The value behind a key in a row of keys and values.
pub(super) fn value_of<'r>(row: &'r StringRecord, key: &str) -> Option<&'r str> {
    let mut cells = row.iter().map(str::trim);
    cells.find(|cell| cell.eq_ignore_ascii_case(key))?;
    cells.next()
}

/// A unit of length by its name, m.
pub(super) fn length_unit(name: &str) -> Result<f64, MotionCaptureProblem> {
    match name.to_ascii_lowercase().as_str() {
        "meters" | "m" => Ok(1.0),
        "centimeters" | "cm" => Ok(1e-2),
        "millimeters" | "mm" => Ok(1e-3),
        _ => Err(MotionCaptureProblem::Unit(shown(name))),
    }
}

/// A unit of angles by its name, rad.
pub(super) fn angle_unit(name: &str) -> Result<f64, MotionCaptureProblem> {
    match name.to_ascii_lowercase().as_str() {
        "deg" => Ok(std::f64::consts::PI / 180.0),
        "rad" => Ok(1.0),
        _ => Err(MotionCaptureProblem::Unit(shown(name))),
    }
}

/// A rate of frames, Hz.
pub(super) fn rate_hz(text: &str) -> Result<f64, MotionCaptureProblem> {
    let rate = text.parse().ok().filter(|rate: &f64| rate.is_finite() && *rate > 0.0);
    rate.ok_or_else(|| MotionCaptureProblem::Unit(shown(text)))
}

/// All of the columns, or none where one is missing.
pub(super) fn all<const K: usize>(columns: [Option<usize>; K]) -> Option<[usize; K]> {
    let mut found = [0; K];
    for (found, column) in found.iter_mut().zip(columns) {
        *found = column?;
    }
    Some(found)
}
