//! A camera above the arm that follows a marker at its base and one at each segment's end.

use crate::constants::{
    CAMERA_BASE, CAMERA_CLOCK_AHEAD_S, CAMERA_CLOCK_FAST, CAMERA_DROPPED_SHARE, CAMERA_FRAMES_PER_S,
    CAMERA_HEADING_NOISE_RAD, CAMERA_HIDDEN_SHARE, CAMERA_PLACE_NOISE_M, CAMERA_STAMP_NOISE_S, GRID_S,
};
use crate::layout::PerSegment;
use crate::noise::{Noise, Seeds, Source};
use crate::pose::EndPose;
use core::f64::consts::TAU;

/// One picture in the camera's frame: x to the right and y up, headings clockwise from y, within ±π.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time by the camera's clock, s.
    pub time_s: f64,
    /// Pose of the base: the origin and the y axis of {W}.
    pub base: Option<EndPose>,
    /// Pose of each segment's end; `None`: the marker was not found.
    pub ends: PerSegment<Option<EndPose>>,
}

/// The camera. Its clock starts elsewhere than the rig's and runs at another rate.
#[derive(Clone, Debug)]
pub struct Camera {
    frames: u64,
    noise: Noise,
}

impl Camera {
    /// The camera in the session of `seed`.
    pub fn new(seed: u64) -> Self {
        Self { frames: 0, noise: Noise::of_session(Seeds { arm: 0, session: seed }, Source::Camera, 0) }
    }

    /// Time of the next frame by the rig's clock, s: a grid point, at which the truth is exact.
    pub fn next_s(&self) -> f64 {
        (self.frames as f64 / (CAMERA_FRAMES_PER_S * GRID_S)).round() * GRID_S
    }

    /// Takes the next frame of the arm; `None`: the frame was dropped.
    pub fn take(&mut self, truth: &[EndPose]) -> Option<Frame> {
        let taken_s = self.next_s();
        self.frames += 1;
        let stamp_s = taken_s + CAMERA_STAMP_NOISE_S * self.noise.gaussian();
        let time_s = CAMERA_CLOCK_AHEAD_S + stamp_s * (1.0 + CAMERA_CLOCK_FAST);
        let dropped = self.noise.uniform() < CAMERA_DROPPED_SHARE;
        let base = self.find(EndPose::default());
        let ends = truth.iter().map(|pose| self.find(*pose)).collect();
        (!dropped).then_some(Frame { time_s, base, ends })
    }

    /// One marker in the picture.
    fn find(&mut self, pose: EndPose) -> Option<EndPose> {
        let (sin, cos) = libm::sincos(CAMERA_BASE.heading_rad);
        let heading_rad = CAMERA_BASE.heading_rad + pose.heading_rad + CAMERA_HEADING_NOISE_RAD * self.noise.gaussian();
        let found = EndPose {
            x_m: CAMERA_BASE.x_m + pose.x_m * cos + pose.y_m * sin + CAMERA_PLACE_NOISE_M * self.noise.gaussian(),
            y_m: CAMERA_BASE.y_m - pose.x_m * sin + pose.y_m * cos + CAMERA_PLACE_NOISE_M * self.noise.gaussian(),
            heading_rad: heading_rad - TAU * (heading_rad / TAU).round(),
        };
        (self.noise.uniform() >= CAMERA_HIDDEN_SHARE).then_some(found)
    }
}
