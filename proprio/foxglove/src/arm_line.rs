//! The line along a segment, for drawing: its connector and its arc.

use calibration_tables::{SegmentToml, Side};

/// Pieces of an arc.
const PIECES: u32 = 12;

/// Geometry of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    arc_m: f64,
    connector_m: f64,
    /// The connector follows the arc.
    connector_at_end: bool,
}

impl From<&SegmentToml> for Geometry {
    fn from(segment: &SegmentToml) -> Self {
        Self {
            arc_m: segment.length_mm / 1e3,
            connector_m: segment.offset_mm / 1e3,
            connector_at_end: segment.offset_at == Side::End,
        }
    }
}

/// A point and the heading of the tangent there, clockwise from y.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_rad: f64,
}

/// Points from a segment's start to its end, m, for the bend angle `theta_rad`. Without a geometry the whole segment is an arc.
/// The estimated end and that of the geometry may differ by some mm, as positions and angles are filtered apart: the difference
/// is spread over the points.
pub fn segment_line(start: Pose, theta_rad: f64, end: [f64; 2], geometry: Option<Geometry>) -> Vec<[f64; 2]> {
    let chord_m = (end[0] - start.x_m).hypot(end[1] - start.y_m);
    let arc = Geometry { arc_m: chord_m / sinc(theta_rad / 2.0), connector_m: 0.0, connector_at_end: false };
    let Geometry { arc_m, connector_m, connector_at_end } = geometry.unwrap_or(arc);
    let has_connector = connector_m > 0.0;

    let mut points = vec![[start.x_m, start.y_m]];
    let mut go = |distance_m: f64, heading_rad: f64| {
        let [x, y] = points[points.len() - 1];
        points.push([x + distance_m * heading_rad.sin(), y + distance_m * heading_rad.cos()]);
    };
    if has_connector && !connector_at_end {
        go(connector_m, start.heading_rad);
    }
    let piece_rad = theta_rad / f64::from(PIECES);
    let piece_m = arc_m / f64::from(PIECES) * sinc(piece_rad / 2.0);
    for piece in 0..PIECES {
        go(piece_m, start.heading_rad + (f64::from(piece) + 0.5) * piece_rad);
    }
    if has_connector && connector_at_end {
        go(connector_m, start.heading_rad + theta_rad);
    }

    let last = points.len() - 1;
    let difference = [0, 1].map(|axis| end[axis] - points[last][axis]);
    for (i, point) in points.iter_mut().enumerate() {
        let share = i as f64 / last as f64;
        *point = [0, 1].map(|axis| point[axis] + share * difference[axis]);
    }
    points
}

/// sin x / x: a chord over its arc with half the angle x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-6 { 1.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::{Geometry, Pose, segment_line};

    const BASE: Pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };

    #[test]
    fn a_quarter_turn_without_a_geometry_is_an_arc() {
        let line = segment_line(BASE, FRAC_PI_2, [0.1, 0.1], None);
        for [x, y] in line {
            assert!(((x - 0.1).hypot(y) - 0.1).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn a_line_begins_and_ends_where_it_is_told_with_a_straight_connector() {
        for connector_at_end in [false, true] {
            let geometry = Geometry { arc_m: FRAC_PI_2 / 10.0, connector_m: 0.02, connector_at_end };
            let end = if connector_at_end { [0.12, 0.1] } else { [0.1, 0.12] };
            let line = segment_line(BASE, FRAC_PI_2, end, Some(geometry));
            assert!(line[0][0].hypot(line[0][1]) < 1e-12, "{line:?}");
            let last = line.len() - 1;
            assert!((line[last][0] - end[0]).abs() + (line[last][1] - end[1]).abs() < 1e-12, "{line:?}");
            let [from, to] = if connector_at_end { [line[last - 1], line[last]] } else { [line[0], line[1]] };
            let connector_m = (to[0] - from[0]).hypot(to[1] - from[1]);
            assert!((connector_m - 0.02).abs() < 1e-9, "{line:?}");
        }
    }

    #[test]
    fn a_straight_segment_is_straight() {
        let line = segment_line(BASE, 0.0, [0.0, 0.09], None);
        assert!(line.iter().all(|[x, _]| x.abs() < 1e-12) && line.is_sorted_by(|a, b| a[1] < b[1]), "{line:?}");
    }
}
