//! The base's marker: pose of {W} in the camera's frame.

use nalgebra::{Rotation2, Vector2};
use proprio_session::Pose;

use super::angle::unwrap_near;
use super::error::AlignmentError;

/// Parts of a recording by which camera and base are checked to be at rest.
const PARTS: usize = 10;
/// Largest distance of a part's base from that of all, m.
const STILL_M: f64 = 0.005;
/// Largest angle between them, rad.
const STILL_RAD: f64 = 0.035;

/// Pose of the base in the camera's frame: the median of all frames, so that the noise of single frames is not in the truth.
pub(super) fn median(mut seen: Vec<Pose>) -> Result<Pose, AlignmentError> {
    let first = seen.first().ok_or(AlignmentError::NoBase)?.heading_rad;
    for pose in &mut seen {
        pose.heading_rad = unwrap_near(pose.heading_rad, first);
    }
    let all = middle(&seen);
    for part in seen.chunks(seen.len().div_ceil(PARTS)) {
        let part = middle(part);
        let (dx, dy) = (part.x_m - all.x_m, part.y_m - all.y_m);
        let (moved_m, turned_rad) = ((dx * dx + dy * dy).sqrt(), (part.heading_rad - all.heading_rad).abs());
        if moved_m > STILL_M || turned_rad > STILL_RAD {
            return Err(AlignmentError::BaseMoved { mm: moved_m * 1e3, deg: turned_rad.to_degrees() });
        }
    }
    Ok(all)
}

fn middle(poses: &[Pose]) -> Pose {
    let median = |of: fn(&Pose) -> f64| {
        let mut values: Vec<f64> = poses.iter().map(of).collect();
        let half = values.len() / 2;
        *values.select_nth_unstable_by(half, f64::total_cmp).1
    };
    Pose { x_m: median(|pose| pose.x_m), y_m: median(|pose| pose.y_m), heading_rad: median(|pose| pose.heading_rad) }
}

/// Transforms a pose from the camera's frame to that of the base.
pub(super) fn from_base(base: &Pose, pose: &Pose) -> Pose {
    // Headings are clockwise, so that this turns back.
    let place = Rotation2::new(base.heading_rad) * Vector2::new(pose.x_m - base.x_m, pose.y_m - base.y_m);
    Pose { x_m: place.x, y_m: place.y, heading_rad: pose.heading_rad - base.heading_rad }
}

#[cfg(test)]
mod tests {
    use super::{from_base, median};
    use proprio_session::Pose;

    const fn pose(x_m: f64, y_m: f64, heading_deg: f64) -> Pose {
        Pose { x_m, y_m, heading_rad: heading_deg / 180.0 * std::f64::consts::PI }
    }

    /// The base looks to the right of the picture: its y axis is the picture's x, its x axis points down.
    #[test]
    fn a_pose_to_the_right_of_a_base_that_looks_right_is_ahead_of_it() {
        let seen = from_base(&pose(1.0, 2.0, 90.0), &pose(1.5, 1.9, 120.0));
        assert!((seen.x_m - 0.1).abs() < 1e-12 && (seen.y_m - 0.5).abs() < 1e-12, "{seen:?}");
        assert!((seen.heading_rad.to_degrees() - 30.0).abs() < 1e-9, "{seen:?}");
    }

    #[test]
    fn the_median_is_no_worse_for_wild_frames_and_a_heading_around_180_degrees() {
        let mut seen: Vec<Pose> = (0..100).map(|k| pose(0.3, 0.1, if k % 2 == 0 { 179.9 } else { -179.9 })).collect();
        seen[7] = pose(9.0, 9.0, 20.0);
        let base = median(seen).expect("it does not move");
        assert!(
            (base.x_m - 0.3).abs() < 1e-12 && (base.heading_rad.to_degrees().abs() - 180.0).abs() < 0.11,
            "{base:?}"
        );
    }
}
