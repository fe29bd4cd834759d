//! The chain of the true poses: each segment's end as seen from the end before it, against constant curvature.

use calibration_tables::{ArmFile, MAX_SEGMENTS, SegmentToml, Side};
use estimator_core::{Angle, OffsetAt, Pcc, SegmentConfig};
use nalgebra::{Rotation2, Vector2};
use proprio_session::Truth;

/// A segment without its sensors.
#[must_use]
pub fn geometry(segment: &SegmentToml) -> SegmentConfig<f64> {
    let offset_at = match segment.offset_at {
        Side::Start => OffsetAt::Start,
        Side::End => OffsetAt::End,
    };
    let plain = SegmentConfig::uncalibrated(segment.length_mm / 1000.0, segment.offset_mm / 1000.0);
    SegmentConfig { offset_at, ..plain }
}

/// Segments of an arm.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    segments: Vec<Pcc<f64>>,
    /// Length of each segment with its connector, m.
    pub lengths: Vec<f64>,
}

/// A segment's end in the frame of its start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// The true end, m.
    pub end: Vector2<f64>,
    /// The end by constant curvature with the true headings, m.
    pub expected: Vector2<f64>,
    /// True heading of its start, rad.
    pub start_rad: f64,
}

/// The links of a row; `None` without the poses.
pub(super) type Links = [Option<Link>; MAX_SEGMENTS];

/// Pose of the base.
pub(super) const BASE: Truth = Truth { x_m: 0.0, y_m: 0.0, heading_rad: Some(0.0) };

impl Chain {
    pub fn new(arm: &ArmFile) -> Self {
        let lengths = arm.segments.iter().map(|segment| (segment.length_mm + segment.offset_mm) / 1000.0).collect();
        let segments = arm.segments.iter().map(|segment| Pcc::new(&geometry(segment))).collect();
        Self { segments, lengths }
    }

    pub fn count(&self) -> usize {
        self.segments.len()
    }

    /// Segment `i` from the end before it to its own; `None` without their headings.
    pub fn link(&self, i: usize, poses: &[Option<Truth>; MAX_SEGMENTS]) -> Option<Link> {
        let before = if i == 0 { BASE } else { poses[i - 1]? };
        let own = poses[i]?;
        let start_rad = before.heading_rad?;
        let turn = wrapped(own.heading_rad? - start_rad);
        // Headings are clockwise, so that this turns back.
        let end = Rotation2::new(start_rad) * Vector2::new(own.x_m - before.x_m, own.y_m - before.y_m);
        let expected = self.segments[i].link(Angle::from(turn)).end;
        Some(Link { end, expected, start_rad })
    }

    /// All links of a row.
    pub fn links(&self, poses: &[Option<Truth>; MAX_SEGMENTS]) -> Links {
        let mut links = [None; MAX_SEGMENTS];
        for (i, link) in links.iter_mut().enumerate().take(self.count()) {
            *link = self.link(i, poses);
        }
        links
    }
}

/// Distance of two poses, m.
pub(super) fn distance(a: &Truth, b: &Truth) -> f64 {
    Vector2::new(a.x_m - b.x_m, a.y_m - b.y_m).norm()
}

/// An angle within half a turn, rad.
pub(super) fn wrapped(rad: f64) -> f64 {
    if rad.abs() < std::f64::consts::PI {
        return rad;
    }
    rad - std::f64::consts::TAU * (rad / std::f64::consts::TAU).round()
}
