//! Sensors that repeat a value while others move.

use calibration_tables::MAX_SEGMENTS;

use super::finding::{Finding, Kind, Rows, Source};
use super::frame::{Frame, difference};

/// Least motion of the other sensors during the repeats, deg: both references of a sensor must show it. A bend sensor whose
/// twin repeats its value, too, is compared with the IMUs alone.
const MOTION: f64 = 20.0;
/// Least duration of the repeats, s, and their least number.
const SECONDS: f64 = 1.0;
const REPEATS: u64 = 5;
/// Places of a segment: bend sensors a and b, IMU.
const PLACES: usize = 3;

/// Range of a value.
#[derive(Debug, Clone, Copy)]
struct Span([f64; 2]);

impl Span {
    const EMPTY: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    fn add(&mut self, value: f64) {
        // `min` and `max` ignore NaN.
        self.0 = [self.0[0].min(value), self.0[1].max(value)];
    }

    /// Width; `None` without a value.
    fn width(&self) -> Option<f64> {
        (self.0[1] >= self.0[0]).then(|| self.0[1] - self.0[0])
    }
}

/// Repeats of one sensor's value, and the motion meanwhile.
#[derive(Debug, Clone, Copy)]
struct Repeats {
    value: Option<i32>,
    run: Rows,
    references: [Span; 2],
    changes: u64,
    frozen: Rows,
    motion: f64,
}

impl Repeats {
    const NONE: Self = Self {
        value: None,
        run: Rows { count: 0, first: 0, last: 0, from_s: 0.0, to_s: 0.0 },
        references: [Span::EMPTY; 2],
        changes: 0,
        frozen: Rows { count: 0, first: 0, last: 0, from_s: 0.0, to_s: 0.0 },
        motion: 0.0,
    };

    /// Takes a reading; `ignores_still`: a reference that does not change at all is frozen, too.
    fn update(&mut self, frame: &Frame, value: Option<i32>, references: [f64; 2], ignores_still: bool) {
        let Some(value) = value else { return };
        if self.value != Some(value) {
            self.end(ignores_still);
            self.changes += u64::from(self.value.is_some());
            self.value = Some(value);
            self.run = Rows::default();
            self.references = [Span::EMPTY; 2];
        }
        self.run.add(frame);
        for (span, reference) in self.references.iter_mut().zip(references) {
            span.add(reference);
        }
    }

    fn end(&mut self, ignores_still: bool) {
        if self.run.count < REPEATS || self.run.to_s - self.run.from_s < SECONDS {
            return;
        }
        let widths = self.references.iter().filter_map(Span::width);
        let motion = widths.filter(|width| !ignores_still || *width > 0.0).reduce(f64::min).unwrap_or(0.0);
        if motion >= MOTION {
            self.frozen.append(&self.run);
            self.motion = self.motion.max(motion);
        }
    }
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Frozen {
    /// False with an arm description: the motion of a bend sensor is not known.
    has_maps: bool,
    /// Range of each IMU's heading.
    headings: [Span; MAX_SEGMENTS],
    sensors: [[Repeats; PLACES]; MAX_SEGMENTS],
    segments: usize,
}

impl Frozen {
    pub fn new(segments: usize, has_maps: bool) -> Self {
        Self {
            has_maps,
            headings: [Span::EMPTY; MAX_SEGMENTS],
            sensors: [[Repeats::NONE; PLACES]; MAX_SEGMENTS],
            segments,
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        // Headings by the sensors a alone, and by the sensors b alone.
        let mut sums = [0.0; 2];
        for (i, [a, b, imu]) in self.sensors.iter_mut().enumerate().take(self.segments) {
            let [by_a, by_b] = frame.bend[i];
            sums = [sums[0] + by_a, sums[1] + by_b];
            let theta = difference(&frame.heading, i);
            let [of_a, of_b] = frame.counts[i].map(|counts| counts.map(i32::from));
            a.update(frame, of_a, [by_b, theta], true);
            b.update(frame, of_b, [by_a, theta], true);
            imu.update(frame, frame.headings[i].map(estimator_core::Phase::bits), sums, false);
            self.headings[i].add(frame.heading[i]);
        }
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        if !self.has_maps {
            self.finish_without_maps(findings);
            return;
        }
        for (i, sensors) in self.sensors.iter_mut().enumerate() {
            for (place, repeats) in sensors.iter_mut().enumerate() {
                repeats.end(place < 2);
                if repeats.frozen.count == 0 {
                    continue;
                }
                let sensor = source(i + 1, place);
                let kind = if repeats.changes == 0 { Kind::Constant } else { Kind::Frozen };
                findings.push(Finding { sensor, rows: repeats.frozen, kind, figure: repeats.motion });
            }
        }
    }

    /// Finds the sensors whose value never changes while an IMU turns.
    fn finish_without_maps(&self, findings: &mut Vec<Finding>) {
        let motion = self.headings.iter().filter_map(Span::width).fold(0.0, f64::max);
        if motion < MOTION {
            return;
        }
        for (segment, sensors) in (1..).zip(&self.sensors) {
            for (place, repeats) in sensors.iter().enumerate() {
                if repeats.changes == 0 && repeats.run.count >= REPEATS {
                    let sensor = source(segment, place);
                    findings.push(Finding { sensor, rows: repeats.run, kind: Kind::Constant, figure: motion });
                }
            }
        }
    }
}

fn source(segment: usize, place: usize) -> Source {
    if place < 2 { Source::Bend { segment, place } } else { Source::Imu { segment } }
}
