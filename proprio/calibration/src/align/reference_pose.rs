//! Poses of rigid bodies in {W}, by the arm's reference pose at the start of the recording: a motion-capture program gives a body
//! the axes of the capture volume as it was made, so that neither its heading nor the base's is that of the arm's tangent.

use calibration_tables::ArmFile;
use estimator_core::{Angle, Pcc, forward_kinematics};
use nalgebra::{Rotation2, Vector2};
use proprio_check::truth::geometry;
use proprio_session::Pose;

use super::angle::unwrap_near;
use super::base::median;
use super::error::AlignmentError;

/// Time from the first frame on in which the arm rests in its reference pose, s.
const REST_S: f64 = 1.0;
/// Largest residual of the bodies' places from those of the reference pose, RMS, % of the arm's length.
const MISFIT_PERCENT: f64 = 5.0;

/// Transforms the poses of the segments' ends to {W}. The rigid motion from the capture volume to {W} is the one that brings
/// the bodies' places at rest nearest to the reference pose; a body's heading is its turn since then.
///
/// # Errors
/// A body that is not seen at rest, one that moves there, and places that are not those of the reference pose.
pub(super) fn place(
    arm: &ArmFile,
    times_s: &[f64],
    base: &[Option<Pose>],
    ends: &mut [Vec<Option<Pose>>],
) -> Result<(), AlignmentError> {
    let frames = times_s.partition_point(|time_s| *time_s <= REST_S);
    let has_base = base.iter().any(Option::is_some);
    let reference = reference_pose(arm);
    let seen = |poses: &[Option<Pose>]| poses[..frames].iter().flatten().copied().collect::<Vec<Pose>>();

    let mut resting = Vec::with_capacity(ends.len());
    for (i, end) in ends.iter().enumerate() {
        resting.push(at_rest(seen(end), i + 1)?);
    }
    let mut pairs: Vec<[Vector2<f64>; 2]> =
        resting.iter().zip(&reference).map(|(seen, model)| [point(seen), point(model)]).collect();
    if has_base {
        // A base that moves later spoils the whole recording.
        median(base.iter().flatten().copied().collect())?;
        pairs.push([point(&at_rest(seen(base), 0)?), Vector2::zeros()]);
    }
    let motion = RigidMotion::fit(&pairs);
    let length_m: f64 = arm.segments.iter().map(|segment| (segment.length_mm + segment.offset_mm) / 1e3).sum();
    let (misfit_mm, most_mm) = (motion.residual_m(&pairs) * 1e3, length_m * MISFIT_PERCENT * 10.0);
    if misfit_mm > most_mm {
        return Err(AlignmentError::NotInReferencePose { misfit_mm, most_mm });
    }
    for ((end, rest), model) in ends.iter_mut().zip(&resting).zip(&reference) {
        for pose in end.iter_mut().flatten() {
            let place = motion.apply(point(pose));
            let heading_rad = pose.heading_rad - rest.heading_rad + model.heading_rad;
            *pose = Pose { x_m: place.x, y_m: place.y, heading_rad };
        }
    }
    Ok(())
}

/// The segments' ends in the reference pose.
fn reference_pose(arm: &ArmFile) -> Vec<Pose> {
    let headings = arm.tare.heading_deg.iter().map(|deg| deg.to_radians()).chain(std::iter::repeat(0.0));
    let headings: Vec<f64> = headings.take(arm.segments.len()).collect();
    let links = arm.segments.iter().enumerate().map(|(i, segment)| {
        let before = i.checked_sub(1).map_or(0.0, |before| headings[before]);
        Some(Pcc::new(&geometry(segment)).link(Angle::from(headings[i] - before)))
    });
    let ends = forward_kinematics(links).filter_map(|shape| shape.end);
    ends.zip(&headings).map(|(end, heading)| Pose { x_m: end.x, y_m: end.y, heading_rad: *heading }).collect()
}

/// The median pose of a body at rest; 0 is the base's, others are at the segments' ends.
fn at_rest(mut seen: Vec<Pose>, body: usize) -> Result<Pose, AlignmentError> {
    let first = seen.first().ok_or(AlignmentError::NotSeenAtRest { body })?.heading_rad;
    for pose in &mut seen {
        pose.heading_rad = unwrap_near(pose.heading_rad, first);
    }
    median(seen).map_err(|error| match error {
        AlignmentError::BaseMoved { mm, deg } => AlignmentError::MovedAtRest { body, mm, deg },
        other => other,
    })
}

fn point(pose: &Pose) -> Vector2<f64> {
    Vector2::new(pose.x_m, pose.y_m)
}

/// Rotation and translation from the capture volume's plane to {W}.
struct RigidMotion {
    rotation: Rotation2<f64>,
    from: Vector2<f64>,
    to: Vector2<f64>,
}

impl RigidMotion {
    /// Least squares over pairs of a place and where it belongs (Umeyama 1991, without scale).
    fn fit(pairs: &[[Vector2<f64>; 2]]) -> Self {
        let mean = |of: usize| pairs.iter().map(|pair| pair[of]).sum::<Vector2<f64>>() / pairs.len().max(1) as f64;
        let (from, to) = (mean(0), mean(1));
        let (mut sin, mut cos) = (0.0, 0.0);
        for [seen, model] in pairs {
            let (a, b) = (seen - from, model - to);
            sin += a.x * b.y - a.y * b.x;
            cos += a.dot(&b);
        }
        Self { rotation: Rotation2::new(libm::atan2(sin, cos)), from, to }
    }

    fn apply(&self, place: Vector2<f64>) -> Vector2<f64> {
        self.rotation * (place - self.from) + self.to
    }

    fn residual_m(&self, pairs: &[[Vector2<f64>; 2]]) -> f64 {
        let squares: f64 = pairs.iter().map(|[seen, model]| (self.apply(*seen) - model).norm_squared()).sum();
        (squares / pairs.len().max(1) as f64).sqrt()
    }
}
