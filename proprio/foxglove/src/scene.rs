//! The arm for 3D panels: the transform to the end of each segment, and markers of the arm and its 95 % ellipses.

use calibration_tables::ArmFile;
use proprio_session::recording::{CdrWriter, SegmentEnd, write_header};
use proprio_session::{Ellipse, HostNs};
use telemetry::{Estimate, Event, Message, SegmentUncertainty, Uncertainty};

use crate::arm_line::{Geometry, Pose, segment_line};

/// Width of the arm's line, m.
const WIDTH_M: f64 = 0.02;
/// Height of the disc of an ellipse, m.
const DISC_M: f64 = 0.001;

/// Red, green, blue, alpha.
type Colour = [f32; 4];
/// Colours of the segments, in turn.
const SEGMENTS: [Colour; 2] = [[0.12, 0.40, 0.67, 1.0], [0.42, 0.66, 0.86, 1.0]];
const IN_CONTACT: Colour = [0.84, 0.19, 0.15, 1.0];
const ELLIPSE: Colour = [0.95, 0.61, 0.07, 0.5];

/// Geometry, contact and uncertainty of the arm, which estimates do not contain.
pub struct Scene {
    geometry: Vec<Geometry>,
    uncertainty: Option<Uncertainty>,
}

impl Scene {
    pub fn new(table: Option<&ArmFile>) -> Self {
        let geometry = table.iter().flat_map(|table| &table.segments).map(Geometry::from).collect();
        Self { geometry, uncertainty: None }
    }

    /// Takes a message of the board.
    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Uncertainty(uncertainty) => self.uncertainty = Some(uncertainty.clone()),
            Message::Event(Event::Contact(_, mask)) => {
                let segments = self.uncertainty.iter_mut().flat_map(|uncertainty| &mut uncertainty.segments);
                segments.enumerate().for_each(|(i, segment)| segment.in_contact = mask >> i & 1 == 1);
            }
            _ => {}
        }
    }

    /// Drops what belongs to the board before its restart.
    pub fn forget(&mut self) {
        self.uncertainty = None;
    }

    /// `tf2_msgs/msg/TFMessage`: the end of each segment that is known, `segment1`, `segment2`, …, x along its tangent.
    pub fn transforms(stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
        let ends = SegmentEnd::all(estimate).enumerate().filter(|(_, end)| is_known(end));
        let ends: Vec<(usize, SegmentEnd)> = ends.collect();
        let mut cdr = CdrWriter::new();
        cdr.length(ends.len());
        for (i, end) in ends {
            write_header(&mut cdr, stamp);
            cdr.string(&format!("segment{}", i + 1));
            cdr.floats(&[end.x_m, end.y_m, 0.0]);
            cdr.floats(&end.quaternion());
        }
        cdr.into_bytes()
    }

    /// `visualization_msgs/msg/MarkerArray`: the arm, and the ellipse of each segment's end.
    pub fn arm(&self, stamp: HostNs, estimate: &Estimate) -> Vec<u8> {
        let mut cdr = CdrWriter::new();
        cdr.length(2 * estimate.segments.len());
        let mut start = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        for (i, end) in SegmentEnd::all(estimate).enumerate() {
            let uncertainty = self.uncertainty.as_ref().and_then(|of| of.segments.get(i));
            self.segment(i, start, &end, uncertainty).write(&mut cdr, stamp);
            ellipse(i, &end, uncertainty).write(&mut cdr, stamp);
            start = Pose { x_m: end.x_m, y_m: end.y_m, heading_rad: end.heading_rad };
        }
        cdr.into_bytes()
    }

    fn segment(&self, i: usize, start: Pose, end: &SegmentEnd, uncertainty: Option<&SegmentUncertainty>) -> Marker {
        if !is_known(end) {
            return Marker::removed("arm", i);
        }
        let in_contact = uncertainty.is_some_and(|of| of.in_contact);
        let geometry = self.geometry.get(i).copied();
        Marker {
            kind: Kind::LineStrip,
            scale: [WIDTH_M, 0.0, 0.0],
            colour: if in_contact { IN_CONTACT } else { SEGMENTS[i % SEGMENTS.len()] },
            points: segment_line(start, end.theta_rad, [end.x_m, end.y_m], geometry),
            ..Marker::removed("arm", i)
        }
    }
}

/// The disc of a 95 % ellipse.
fn ellipse(i: usize, end: &SegmentEnd, uncertainty: Option<&SegmentUncertainty>) -> Marker {
    let covariance = uncertainty.and_then(SegmentUncertainty::end_m2).filter(|_| is_known(end));
    let Some(covariance) = covariance else { return Marker::removed("ellipses", i) };
    let Ellipse { major_mm, minor_mm } = Ellipse::of(covariance);
    Marker {
        kind: Kind::Cylinder,
        position: [end.x_m, end.y_m],
        turn_rad: Ellipse::turn_rad(covariance),
        scale: [2e-3 * major_mm, 2e-3 * minor_mm, DISC_M],
        colour: ELLIPSE,
        ..Marker::removed("ellipses", i)
    }
}

fn is_known(end: &SegmentEnd) -> bool {
    [end.x_m, end.y_m, end.heading_rad].iter().all(|value| value.is_finite())
}

/// `visualization_msgs/Marker`'s types, and its action to delete one.
#[derive(Clone, Copy)]
enum Kind {
    Cylinder,
    LineStrip,
    Removed,
}

/// `visualization_msgs/Marker`.
struct Marker {
    namespace: &'static str,
    id: usize,
    kind: Kind,
    position: [f64; 2],
    turn_rad: f64,
    scale: [f64; 3],
    colour: Colour,
    points: Vec<[f64; 2]>,
}

impl Marker {
    /// The one of this number is not there any more.
    fn removed(namespace: &'static str, id: usize) -> Self {
        let (position, turn_rad, scale, colour, points) = Default::default();
        Self { namespace, id, kind: Kind::Removed, position, turn_rad, scale, colour, points }
    }

    fn write(&self, cdr: &mut CdrWriter, stamp: HostNs) {
        let (kind, action) = match self.kind {
            Kind::Cylinder => (3, 0),
            Kind::LineStrip => (4, 0),
            Kind::Removed => (0, 2),
        };
        write_header(cdr, stamp);
        cdr.string(self.namespace);
        cdr.i32(self.id as i32 + 1);
        cdr.i32(kind);
        cdr.i32(action);
        let (sin, cos) = (self.turn_rad / 2.0).sin_cos();
        cdr.floats(&[self.position[0], self.position[1], 0.0]);
        cdr.floats(&[0.0, 0.0, sin, cos]);
        cdr.floats(&self.scale);
        self.colour.iter().for_each(|part| cdr.f32(*part));
        // It stays until it is replaced.
        cdr.i32(0);
        cdr.u32(0);
        cdr.u8(0);
        cdr.length(self.points.len());
        for [x, y] in &self.points {
            cdr.floats(&[*x, *y, 0.0]);
        }
        write_unused(cdr);
    }
}

/// The fields of a marker with a colour for each point, a texture, text or a mesh.
fn write_unused(cdr: &mut CdrWriter) {
    // Colours, and the name of a texture.
    cdr.length(0);
    cdr.string("");
    // A texture: the header, format and data of a picture.
    cdr.u32(0);
    cdr.u32(0);
    cdr.string("");
    cdr.string("");
    cdr.length(0);
    // Its coordinates, a text, the name of a mesh.
    cdr.length(0);
    cdr.string("");
    cdr.string("");
    // A mesh: its name and data, and whether it brings its materials.
    cdr.string("");
    cdr.length(0);
    cdr.u8(0);
}
