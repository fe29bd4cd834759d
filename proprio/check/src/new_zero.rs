//! IMUs whose heading continues from another zero, and single readings of 0: jumps that the bend sensors do not show.

use calibration_tables::MAX_SEGMENTS;

use super::finding::{Finding, Kind, Rows, Source, is_chain_wrong, is_imu_blamed};
use super::frame::{Frame, wrapped};

/// Least jump of the heading against the bend sensors, deg: after missing readings, and from one reading to the next.
const JUMP_AFTER_GAP: f64 = 25.0;
const JUMP: f64 = 40.0;
/// Least jump of a reading of exactly 0, deg.
const ZERO_JUMP: f64 = 10.0;
/// Largest difference of opposite jumps, deg.
const OPPOSITE: f64 = 10.0;
/// Readings after which a jump is another zero, and no single wrong reading.
const PERSISTS: u64 = 5;

/// Jumps of one IMU.
#[derive(Debug, Clone, Copy)]
struct Jumps {
    /// Last heading, and heading by the bend sensors at that time, deg.
    last: [f64; 2],
    /// Readings after a jump.
    after: Rows,
    /// Readings of exactly 0 among them.
    zero: Rows,
    /// Limit of a jump, deg.
    limit: f64,
    new_zero: Rows,
    jump: f64,
    zeros: Rows,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct NewZero([Jumps; MAX_SEGMENTS]);

impl NewZero {
    pub fn new() -> Self {
        let rows = Rows::default();
        let last = [f64::NAN; 2];
        let none = Jumps { last, after: rows, zero: rows, limit: JUMP, new_zero: rows, jump: 0.0, zeros: rows };
        Self([none; MAX_SEGMENTS])
    }

    pub fn update(&mut self, frame: &Frame) {
        for (i, jumps) in self.0.iter_mut().enumerate() {
            if frame.starts {
                jumps.last = [f64::NAN; 2];
                (jumps.after, jumps.zero) = (Rows::default(), Rows::default());
            }
            let now = [frame.heading[i], frame.bend_heading[i]];
            if now[0].is_nan() {
                jumps.limit = JUMP_AFTER_GAP;
            } else if !now[1].is_nan() {
                let is_zero = frame.headings[i].is_some_and(|heading| heading.bits() == 0);
                jumps.update(frame, now, is_zero);
            }
        }
    }

    pub fn finish(&self, findings: &mut Vec<Finding>) {
        self.opposite(findings);
        for (i, jumps) in self.0.iter().enumerate() {
            let sensor = Source::Imu { segment: i + 1 };
            // Readings that catch up jump.
            let is_held = findings.iter().any(|finding| finding.sensor == Source::AllSensors);
            // The jumps of an IMU that turns otherwise than the arm are no other zeros, nor are those against wrong bend angles.
            if is_held || is_imu_blamed(findings, i + 1) || is_chain_wrong(findings, i + 1) {
                continue;
            }
            if jumps.new_zero.count > 0 {
                findings.push(Finding { sensor, rows: jumps.new_zero, kind: Kind::NewZero, figure: jumps.jump });
            }
            if jumps.zeros.count > 0 {
                let figure = jumps.zeros.count as f64;
                findings.push(Finding { sensor, rows: jumps.zeros, kind: Kind::Zeros, figure });
            }
        }
    }

    /// Finds two IMUs that jump at the same row by opposite angles, as those of exchanged plugs do.
    fn opposite(&self, findings: &mut Vec<Finding>) {
        let jumped = |i: usize| {
            let jumps = &self.0[i];
            jumps.new_zero.count == 1 && !is_imu_blamed(findings, i + 1) && !is_chain_wrong(findings, i + 1)
        };
        let jumped: Vec<usize> = (0..MAX_SEGMENTS).filter(|i| jumped(*i)).collect();
        let [one, other] = jumped[..] else { return };
        let [rows, of_other] = [one, other].map(|i| self.0[i].new_zero);
        let [jump, back] = [one, other].map(|i| self.0[i].jump);
        if rows.first == of_other.first && wrapped(jump + back).abs() < OPPOSITE {
            let sensor = Source::TwoImus { segment: one + 1, other: other + 1 };
            findings.push(Finding { sensor, rows, kind: Kind::NewZero, figure: jump.abs() });
        }
    }
}

impl Jumps {
    fn update(&mut self, frame: &Frame, now: [f64; 2], is_zero: bool) {
        let [step, bend_step] = [wrapped(now[0] - self.last[0]), now[1] - self.last[1]];
        let jump = wrapped(step - bend_step);
        let limit = if is_zero { ZERO_JUMP } else { self.limit };
        // A step of a bend sensor is no jump of the IMU. In a gap the arm may turn back by as much as the heading jumps.
        let is_after_gap = self.limit < JUMP;
        let is_jump = jump.abs() > limit && (is_after_gap || step.abs() > bend_step.abs());
        if !is_jump {
            if self.zero.count > 0 {
                self.zeros.append(&self.zero);
            }
            self.settle(now);
            return;
        }
        self.after.add(frame);
        if is_zero {
            self.zero.add(frame);
        }
        if self.after.count >= PERSISTS {
            let row = Rows { count: 1, last: self.after.first, to_s: self.after.from_s, ..self.after };
            if jump.abs() > self.limit {
                self.new_zero.append(&row);
                self.jump = if jump.abs() > self.jump.abs() { jump } else { self.jump };
            }
            self.settle(now);
        }
    }

    fn settle(&mut self, now: [f64; 2]) {
        (self.after, self.zero) = (Rows::default(), Rows::default());
        self.last = now;
        self.limit = JUMP;
    }
}
