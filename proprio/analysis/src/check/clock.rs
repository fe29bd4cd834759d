//! Time stamps: their unit, equal ones, and gaps.

use proprio_session::time_factor;

use super::finding::{Finding, Kind, Rows, Source};
use super::frame::Frame;

/// Rows from whose steps the usual step is found.
const FIRST: usize = 1000;
/// A gap is longer than so many usual steps, and than so many seconds.
const GAP_STEPS: f64 = 5.0;
const GAP_SECONDS: f64 = 0.5;
/// Share of rows with the time of the row before, from which on they are a finding.
const EQUAL_SHARE: f64 = 0.001;

/// A step from one row to the next.
#[derive(Debug, Clone, Copy)]
struct Step {
    seconds: f64,
    row: u64,
    from_s: f64,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Clock {
    rate_hz: f64,
    all: Rows,
    first: Vec<Step>,
    usual_s: Option<f64>,
    equal: Rows,
    gaps: Rows,
    longest_s: f64,
}

impl Clock {
    pub fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            all: Rows::default(),
            first: Vec::with_capacity(FIRST),
            usual_s: None,
            equal: Rows::default(),
            gaps: Rows::default(),
            longest_s: 0.0,
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        let before = self.all;
        self.all.add(frame);
        if before.count == 0 || frame.starts {
            return;
        }
        let step = Step { seconds: frame.time_s - before.to_s, row: frame.row, from_s: before.to_s };
        if step.seconds <= 0.0 {
            self.equal.add(frame);
        }
        if let Some(usual_s) = self.usual_s {
            self.add(step, usual_s);
        } else {
            self.first.push(step);
            if self.first.len() == FIRST {
                self.find_usual();
            }
        }
    }

    fn find_usual(&mut self) {
        let steps = std::mem::take(&mut self.first);
        let mut sorted: Vec<f64> = steps.iter().map(|step| step.seconds).filter(|seconds| *seconds > 0.0).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let Some(usual_s) = sorted.get(sorted.len() / 2).copied() else { return };
        self.usual_s = Some(usual_s);
        for step in steps {
            self.add(step, usual_s);
        }
    }

    fn add(&mut self, step: Step, usual_s: f64) {
        if step.seconds > (GAP_STEPS * usual_s).max(GAP_SECONDS) {
            let gap = Rows {
                count: 1,
                first: step.row - 1,
                last: step.row,
                from_s: step.from_s,
                to_s: step.from_s + step.seconds,
            };
            self.gaps.append(&gap);
            self.longest_s = self.longest_s.max(step.seconds);
        }
    }

    /// Adds the findings; returns `false` where the unit of the times is wrong, by which no other rule can be trusted.
    pub fn finish(mut self, findings: &mut Vec<Finding>) -> bool {
        if self.usual_s.is_none() {
            self.find_usual();
        }
        let mut push = |rows, kind, figure| findings.push(Finding { sensor: Source::Time, rows, kind, figure });
        if let Some(factor) = self.usual_s.and_then(|usual_s| time_factor(self.rate_hz, usual_s.recip())) {
            push(self.all, Kind::TimeUnit, factor);
            return false;
        }
        if self.equal.count as f64 > EQUAL_SHARE * self.all.count as f64 {
            push(self.equal, Kind::EqualTimes, self.equal.count as f64);
        }
        if self.gaps.count > 0 {
            push(self.gaps, Kind::Gaps, self.longest_s);
        }
        true
    }
}
