//! All IMUs that return from a gap with one and the same turn, as after a dip of their supply.
//!
//! A turn of all headings is a turn of the first segment alone: the bend sensors of the others show no change. Their errors tell
//! how well those of the first segment can be trusted, so that a smaller turn is found than by a single IMU.

use calibration_tables::MAX_SEGMENTS;

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed};
use super::frame::{Frame, wrapped};

/// Rows of the means before and after a gap.
const ROWS: f64 = 5.0;
/// Least turn, deg, and as a multiple of the largest error of the other segments. A stick that pushes during a gap turns the first
/// segment by up to 12.3° otherwise than its bend sensors show.
const TURN: f64 = 14.0;
const ERRORS: f64 = 2.0;

/// Headings less those by the bend sensors, deg.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: [f64; MAX_SEGMENTS],
    count: f64,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct CommonZero {
    segments: usize,
    before: [Option<[f64; MAX_SEGMENTS]>; ROWS as usize],
    next: usize,
    /// Difference before the gap, while the rows after it are averaged.
    gap: Option<[f64; MAX_SEGMENTS]>,
    is_gap: bool,
    after: Mean,
    from: Rows,
    found: Rows,
    turn: f64,
}

impl CommonZero {
    pub fn new(segments: usize) -> Self {
        Self {
            segments,
            before: [None; ROWS as usize],
            next: 0,
            gap: None,
            is_gap: false,
            after: Mean::default(),
            from: Rows::default(),
            found: Rows::default(),
            turn: 0.0,
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        if frame.starts {
            *self = Self { found: self.found, turn: self.turn, ..Self::new(self.segments) };
        }
        let n = self.segments;
        if frame.heading[..n].iter().all(|heading| heading.is_nan()) {
            self.is_gap = true;
            return;
        }
        let differences: [f64; MAX_SEGMENTS] = std::array::from_fn(|i| frame.heading[i] - frame.bend_heading[i]);
        if differences[..n].iter().any(|difference| difference.is_nan()) {
            return;
        }
        if std::mem::take(&mut self.is_gap) {
            self.gap = self.mean_before();
            self.before = [None; ROWS as usize];
            self.after = Mean::default();
            self.from = Rows::default();
            self.from.add(frame);
        }
        self.before[self.next] = Some(differences);
        self.next = (self.next + 1) % self.before.len();
        let Some(before) = self.gap else { return };
        for (sum, (now, before)) in self.after.sum.iter_mut().zip(differences.iter().zip(before)) {
            *sum += wrapped(now - before);
        }
        self.after.count += 1.0;
        if self.after.count == ROWS {
            self.gap = None;
            self.judge(&self.after.sum.map(|sum| sum / ROWS));
        }
    }

    /// Judges the turns of the headings against the bend sensors over a gap.
    fn judge(&mut self, turns: &[f64; MAX_SEGMENTS]) {
        let errors = turns[..self.segments].windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let limit = TURN.max(ERRORS * errors.fold(0.0, f64::max));
        if self.segments > 1 && turns[0].abs() > limit {
            self.found.append(&self.from);
            self.turn = if turns[0].abs() > self.turn.abs() { turns[0] } else { self.turn };
        }
    }

    fn mean_before(&self) -> Option<[f64; MAX_SEGMENTS]> {
        let mut mean = [0.0; MAX_SEGMENTS];
        for row in &self.before {
            for (mean, value) in mean.iter_mut().zip((*row)?) {
                *mean += value / ROWS;
            }
        }
        Some(mean)
    }

    pub fn finish(&self, findings: &mut Vec<Finding>) {
        if self.found.count > 0 && !is_bend_blamed(findings, 1) {
            // The same as of single IMUs.
            findings.retain(|finding| finding.kind != Kind::NewZero || finding.rows != self.found);
            findings.push(Finding {
                sensor: Source::AllImus,
                rows: self.found,
                kind: Kind::NewZero,
                figure: self.turn,
            });
        }
    }
}
