//! Poses that are repeated exactly while the arm moves: a lost marker that is held, or truth of a lower rate.
//!
//! An arm at rest repeats its poses as well. A repeat is a fault where the segment's IMU has turned meanwhile and the pose
//! then catches up with it; without an IMU, where the pose catches up in a step that is larger than the next one.

use calibration_tables::MAX_SEGMENTS;
use proprio_session::Truth;

use super::fault::{Fault, FaultKind};
use super::links::{distance, wrapped};
use super::row::TruthRow;
use crate::check::finding::Rows;

/// Least turn of the IMU, rad, and what drift may add to it, rad/s.
const TURN: f64 = 1.0 * std::f64::consts::PI / 180.0;
const DRIFT: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// Turn of the IMU at the end of the session, where no later pose is known, rad.
const LAST_TURN: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Least change of the pose that follows, as a share of the segment's length and in rad.
const CATCH_UP: f64 = 0.02;
/// The same in steps of a truth that is rounded coarsely.
const RESOLUTIONS: f64 = 2.5;
/// Largest difference of the turns by truth and IMU, as a share of the latter.
const DISAGREEMENT: f64 = 0.5;
/// Step of the pose that catches up, over the next step.
const STEPS: f64 = 1.5;

/// Repeats of one segment's pose.
#[derive(Debug, Clone, Copy, Default)]
struct Hold {
    pose: Option<Truth>,
    /// Heading of the IMU at the first of the equal poses, rad.
    imu: Option<f64>,
    since_s: f64,
    /// All repeats.
    repeats: Rows,
    /// Repeats from where the IMU has turned.
    turned: Rows,
    turn: f64,
    /// All segments were repeated in them.
    all: bool,
    /// Found to be wrong by the chain.
    is_confirmed: bool,
}

/// Repeats that have ended, and whose pose did catch up if the next step is small.
#[derive(Debug, Clone, Copy)]
struct Ended {
    rows: Rows,
    all: bool,
    step: f64,
}

/// Smallest changes of a pose, which are those of its rounding or less.
#[derive(Debug, Clone, Copy)]
struct Resolution {
    place: f64,
    heading: f64,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Holds {
    lengths: Vec<f64>,
    resolutions: [Resolution; MAX_SEGMENTS],
    current: [Hold; MAX_SEGMENTS],
    ended: [Option<Ended>; MAX_SEGMENTS],
}

impl Holds {
    pub fn new(lengths: &[f64]) -> Self {
        let resolution = Resolution { place: f64::INFINITY, heading: f64::INFINITY };
        Self {
            lengths: lengths.to_vec(),
            resolutions: [resolution; MAX_SEGMENTS],
            current: [Hold::default(); MAX_SEGMENTS],
            ended: [None; MAX_SEGMENTS],
        }
    }

    /// True where the pose of segment `i` is that of the row before.
    pub fn is_repeated(&self, i: usize, row: &TruthRow) -> bool {
        row.poses[i].is_some() && row.poses[i] == self.current[i].pose
    }

    /// Marks the present repeat of segment `i` as wrong.
    pub fn confirm(&mut self, i: usize) {
        self.current[i].is_confirmed = true;
    }

    /// Adds a row; `scale` is that of the truth over the arm's lengths.
    pub fn update(&mut self, row: &TruthRow, scale: f64, faults: &mut Vec<Fault>) {
        let segments = 0..self.lengths.len();
        let turn = |hold: &Hold, i: usize| {
            let turn = hold.imu.zip(row.imu[i]).filter(|_| !row.starts).map(|(from, to)| wrapped(to - from));
            turn.map(|turn| (turn, turn.abs() >= TURN + DRIFT * (row.time_s - hold.since_s)))
        };
        let all = segments.clone().all(|i| row.poses[i].is_none() || self.is_repeated(i, row));
        let any_turned = segments.clone().any(|i| turn(&self.current[i], i).is_some_and(|(_, is_turned)| is_turned));
        let mut caught_up = [false; MAX_SEGMENTS];
        for i in segments.clone() {
            let hold = &mut self.current[i];
            let Some(pose) = row.poses[i] else {
                // A held pose is in every row.
                *hold = Hold::default();
                continue;
            };
            let turned = turn(hold, i);
            if hold.pose == Some(pose) {
                let is_turned = turned.is_some_and(|(_, is_turned)| is_turned) || all && any_turned;
                hold.repeats.append(&row.rows());
                hold.all |= all && (is_turned || hold.imu.is_none());
                if is_turned || hold.turned.count > 0 || hold.is_confirmed {
                    hold.turned.append(&row.rows());
                    hold.turn = turned.map_or(hold.turn, |(turn, _)| turn.abs().max(hold.turn));
                }
                continue;
            }
            let resolution = &mut self.resolutions[i];
            if let Some(before) = &hold.pose {
                resolution.update(before, &pose);
            }
            let limits = [
                (CATCH_UP * self.lengths[i] * scale).max(RESOLUTIONS * resolution.place),
                CATCH_UP.max(RESOLUTIONS * resolution.heading),
            ];
            let turned = turned.map(|(turn, _)| turn);
            caught_up[i] = hold.turned.count > 0 && (hold.is_confirmed || hold.catches_up(&pose, turned, limits));
        }
        let any_caught_up = segments.clone().any(|i| caught_up[i] && self.current[i].all);
        for i in segments {
            let Some(pose) = row.poses[i].filter(|pose| Some(*pose) != self.current[i].pose) else { continue };
            let hold = &self.current[i];
            if caught_up[i] || hold.all && any_caught_up {
                faults.push(hold.fault(i));
            }
            self.catch_up_without_imu(i, &pose, scale, faults);
            self.current[i] = Hold { pose: Some(pose), imu: row.imu[i], since_s: row.time_s, ..Hold::default() };
        }
    }

    /// Compares the step that ended a repeat with the one after it, where there is no IMU.
    fn catch_up_without_imu(&mut self, i: usize, pose: &Truth, scale: f64, faults: &mut Vec<Fault>) {
        let hold = &self.current[i];
        let Some(before) = hold.pose else { return };
        let length = self.lengths[i] * scale;
        let step = distance(pose, &before) + length * turn_between(pose, &before).abs();
        if let Some(ended) = self.ended[i].take() {
            // The pose after a repeat that is repeated itself has no step.
            let next = if hold.repeats.count > 0 { 0.0 } else { step };
            if ended.step > STEPS * next {
                faults.push(Fault { segment: i, rows: ended.rows, kind: kind(ended.all) });
            }
        }
        let Resolution { place, heading } = self.resolutions[i];
        let limit = (CATCH_UP * length).max(RESOLUTIONS * (place + length * heading));
        if hold.repeats.count > 0 && hold.imu.is_none() && step > limit {
            self.ended[i] = Some(Ended { rows: hold.repeats, all: hold.all, step });
        }
    }

    /// Adds the faults at the end of the session.
    pub fn finish(&mut self, faults: &mut Vec<Fault>) {
        for (i, hold) in self.current.iter().enumerate() {
            if hold.turned.count > 0 && (hold.is_confirmed || hold.turn > LAST_TURN) {
                faults.push(hold.fault(i));
            }
        }
    }
}

impl Resolution {
    fn update(&mut self, before: &Truth, pose: &Truth) {
        let smaller = |least: f64, change: f64| if change > 0.0 { least.min(change) } else { least };
        self.place = smaller(smaller(self.place, (pose.x_m - before.x_m).abs()), (pose.y_m - before.y_m).abs());
        self.heading = smaller(self.heading, turn_between(pose, before).abs());
    }
}

impl Hold {
    /// True where the change to `pose` is that of the IMU.
    fn catches_up(&self, pose: &Truth, imu_turn: Option<f64>, limits: [f64; 2]) -> bool {
        let Some(before) = self.pose else { return false };
        let turn = turn_between(pose, &before);
        let agrees = pose.heading_rad.is_none()
            || imu_turn.is_some_and(|imu| (turn - imu).abs() <= TURN.max(DISAGREEMENT * imu.abs()));
        agrees && (distance(pose, &before) > limits[0] || turn.abs() > limits[1])
    }

    fn fault(&self, segment: usize) -> Fault {
        Fault { segment, rows: self.turned, kind: kind(self.all) }
    }
}

fn turn_between(pose: &Truth, before: &Truth) -> f64 {
    pose.heading_rad.zip(before.heading_rad).map_or(0.0, |(to, from)| wrapped(to - from))
}

const fn kind(all: bool) -> FaultKind {
    if all { FaultKind::AllRepeated } else { FaultKind::Repeated }
}
