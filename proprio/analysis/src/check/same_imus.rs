//! Two IMUs that give the same readings: one channel of the multiplexer.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::Phase;

use super::finding::{Finding, Kind, Rows, Source};
use super::frame::Frame;

/// Least number of equal readings in a row that differ from the ones before.
const CHANGES: u64 = 15;

/// Equal readings of two IMUs.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    changed: u64,
    equal: u64,
    /// Equal readings since the last pair that differs.
    run: Rows,
    same: Rows,
}

impl Pair {
    fn end(&mut self) {
        if self.run.count >= CHANGES {
            self.same.append(&self.run);
        }
        self.run = Rows::default();
    }
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct SameImus {
    segments: usize,
    last: [Option<Phase>; MAX_SEGMENTS],
    pairs: Vec<Pair>,
}

impl SameImus {
    pub fn new(segments: usize) -> Self {
        Self { segments, last: [None; MAX_SEGMENTS], pairs: vec![Pair::default(); segments * (segments - 1) / 2] }
    }

    pub fn update(&mut self, frame: &Frame) {
        let mut pairs = self.pairs.iter_mut();
        for i in 0..self.segments {
            for j in 0..i {
                let Some(pair) = pairs.next() else { return };
                let (Some(one), Some(other)) = (frame.headings[i], frame.headings[j]) else { continue };
                if one != other {
                    pair.end();
                }
                // An arm at rest repeats its readings, which may be equal by chance.
                if Some(one) != self.last[i] && Some(other) != self.last[j] {
                    pair.changed += 1;
                    if one == other {
                        pair.equal += 1;
                        pair.run.add(frame);
                    }
                }
            }
        }
        for (last, heading) in self.last.iter_mut().zip(frame.headings) {
            *last = heading.or(*last);
        }
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        let mut pairs = self.pairs.iter_mut();
        for i in 0..self.segments {
            for j in 0..i {
                let Some(pair) = pairs.next() else { return };
                pair.end();
                if pair.same.count > 0 {
                    let figure = 100.0 * pair.equal as f64 / pair.changed as f64;
                    let sensor = Source::TwoImus { segment: j + 1, other: i + 1 };
                    findings.push(Finding { sensor, rows: pair.same, kind: Kind::SameReadings, figure });
                }
            }
        }
    }
}
