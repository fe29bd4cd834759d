//! The camera's frames in {W}, and interpolated poses.

use std::path::Path;

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use proprio_check::clock_fit::Reading;
use proprio_check::truth::{LeftOut, TruthRow};
use proprio_session::{BodySelection, CameraReader, FileDefects, Pose, Progress, SessionError, SessionProblem, Truth};

use super::angle::unwrap_near;
use super::base;
use super::error::AlignmentError;
use super::reference_pose;
use crate::error::Error;
use crate::truth::{JudgedTruth, TruthJudge};

/// Longest time between two frames over which a pose is interpolated, s.
const LONGEST_GAP_S: f64 = 0.2;

/// All frames. Headings are unwrapped.
pub(super) struct Frames {
    /// Time of the first frame by the camera's clock.
    pub first_s: f64,
    pub defects: FileDefects,
    /// Names of the bodies of a motion-capture program's export.
    pub bodies: Option<Vec<String>>,
    /// Times since the first frame.
    times_s: Vec<f64>,
    /// The marker at each segment's end, frame by frame.
    ends: Vec<Vec<Option<Pose>>>,
    /// The findings about them; wrong poses are left out.
    pub truth: JudgedTruth,
}

impl Frames {
    pub fn read(
        camera: &Path,
        bodies: &BodySelection,
        arm: &ArmFile,
        progress: &mut dyn Progress,
    ) -> Result<Self, Error> {
        let segments = arm.segments.len();
        let mut reader = CameraReader::open(camera, segments, bodies)?;
        let work = format!("reading {}", camera.display());
        let (mut first_s, mut times_s, mut ends) = (0.0, Vec::new(), vec![Vec::new(); segments]);
        let mut base = Vec::new();
        while let Some(frame) = reader.next_frame()? {
            if times_s.is_empty() {
                first_s = frame.time_s;
            }
            times_s.push(frame.time_s - first_s);
            base.push(frame.base);
            for (end, seen) in ends.iter_mut().zip(frame.ends) {
                end.push(seen);
            }
            progress.advance(&work, reader.progress());
        }
        if times_s.is_empty() {
            let path = camera.to_owned();
            return Err(SessionError { path, line: None, column: None, problem: SessionProblem::NoSamples }.into());
        }
        let refuse = |source| Error::Alignment { path: camera.to_owned(), source };
        if ends.iter().flatten().all(Option::is_none) {
            return Err(refuse(AlignmentError::NoMarkers));
        }
        let bodies = reader.bodies();
        if bodies.is_some() {
            reference_pose::place(arm, &times_s, &base, &mut ends).map_err(refuse)?;
        } else if reader.has_base() {
            let base = base::median(base.into_iter().flatten().collect()).map_err(refuse)?;
            // Zeros are no pose in any frame.
            let seen = ends.iter_mut().flatten().flatten().filter(|pose| pose.x_m != 0.0 || pose.y_m != 0.0);
            seen.for_each(|pose| *pose = base::from_base(&base, pose));
        }
        let (truth, left_out) = judge(camera, arm, first_s, &times_s, &ends)?;
        for (i, end) in ends.iter_mut().enumerate() {
            for (frame, pose) in end.iter_mut().enumerate() {
                *pose = pose.filter(|_| !left_out.contains(frame, i));
            }
            unwrap(end);
        }
        Ok(Self { first_s, defects: reader.defects(), bodies, times_s, ends, truth })
    }

    pub fn segments(&self) -> usize {
        self.ends.len()
    }

    /// Time from the first frame to the last, s.
    pub fn seconds(&self) -> f64 {
        self.times_s.last().copied().unwrap_or_default()
    }

    /// Headings of the segments' ends.
    pub fn headings(&self) -> Vec<Vec<Reading>> {
        let heading = |pose: &Option<Pose>| pose.map(|pose| pose.heading_rad);
        self.ends.iter().map(|end| self.timed(end.iter().map(heading))).collect()
    }

    /// Bend angles of the segments.
    pub fn bends(&self) -> Vec<Vec<Reading>> {
        let bend = |i: usize, frame: usize| {
            let before = if i == 0 { 0.0 } else { self.ends[i - 1][frame]?.heading_rad };
            Some(self.ends[i][frame]?.heading_rad - before)
        };
        let frames = 0..self.times_s.len();
        (0..self.ends.len()).map(|i| self.timed(frames.clone().map(|frame| bend(i, frame)))).collect()
    }

    fn timed(&self, values: impl Iterator<Item = Option<f64>>) -> Vec<Reading> {
        self.times_s.iter().zip(values).filter_map(|(time_s, value)| Some((*time_s, value?))).collect()
    }

    /// Poses of all segments' ends at a time since the first frame, interpolated between the frames before and after it
    /// that have the marker; `None` where these are far apart or missing.
    pub fn poses_at(&self, time_s: f64) -> impl Iterator<Item = Option<Pose>> {
        let next = self.times_s.partition_point(|frame_s| *frame_s <= time_s);
        self.ends.iter().map(move |end| self.pose_at(end, next, time_s))
    }

    fn pose_at(&self, end: &[Option<Pose>], next: usize, time_s: f64) -> Option<Pose> {
        let seen = |frame: usize| Some((self.times_s[frame], end[frame]?));
        let near = |frame: &usize| (self.times_s[*frame] - time_s).abs() <= LONGEST_GAP_S;
        let (from_s, from) = (0..next).rev().take_while(near).find_map(seen)?;
        let (to_s, to) = (next..end.len()).take_while(near).find_map(seen)?;
        if to_s - from_s > LONGEST_GAP_S {
            return None;
        }
        let share = (time_s - from_s) / (to_s - from_s);
        let between = |from: f64, to: f64| from + (to - from) * share;
        Some(Pose {
            x_m: between(from.x_m, to.x_m),
            y_m: between(from.y_m, to.y_m),
            heading_rad: between(from.heading_rad, to.heading_rad),
        })
    }
}

/// Judges the poses of all frames.
fn judge(
    camera: &Path,
    arm: &ArmFile,
    first_s: f64,
    times_s: &[f64],
    ends: &[Vec<Option<Pose>>],
) -> Result<(JudgedTruth, LeftOut), Error> {
    let mut judge = TruthJudge::new(camera, arm);
    for (frame, time_s) in times_s.iter().enumerate() {
        let mut poses = [None; MAX_SEGMENTS];
        for (truth, end) in poses.iter_mut().zip(ends) {
            *truth =
                end[frame].map(|Pose { x_m, y_m, heading_rad }| Truth { x_m, y_m, heading_rad: Some(heading_rad) });
        }
        let row = frame as u64 + 1;
        judge.update(&TruthRow { row, time_s: first_s + time_s, starts: false, poses, imu: [None; MAX_SEGMENTS] });
    }
    judge.finish()
}

/// Unwraps headings, beginning within ±π.
fn unwrap(end: &mut [Option<Pose>]) {
    let mut last = 0.0;
    for pose in end.iter_mut().flatten() {
        pose.heading_rad = unwrap_near(pose.heading_rad, last);
        last = pose.heading_rad;
    }
}
