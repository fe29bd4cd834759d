//! Steps of the IMUs against those of the bend sensors, over a second: exchanged plugs, an inverted IMU, another unit, an IMU
//! that shows no heading.
//!
//! The steps' second moments are summed, so that any wiring can be judged at the end: θ_imu,i = g_i h_i − g_{i−1} h_{i−1} with
//! gains g and channels in any order. The misfit of a segment is q = E(Δθ_imu − Δθ_bend)² / (E Δθ_imu² + E Δθ_bend²): 0 for
//! equal steps, 1 for unrelated ones, 2 for opposite ones.

mod exchanges;
mod fit;
mod judge;
mod moments;
mod wiring;

use calibration_tables::MAX_SEGMENTS;
use estimator_core::ImuReading;

use self::exchanges::Exchanges;
use self::fit::Fit;
use self::judge::{Facts, Judge};
use self::moments::Moments;
use super::finding::{Finding, Rows, is_unblamed};
use super::frame::{Frame, difference};
use super::plugs::Plugs;
use super::quaternions::Quaternions;

/// Shortest and longest interval of a step, s. Sessions at less than 1 Hz have their own interval.
const INTERVAL_S: f64 = 0.999;
const LONGEST_S: f64 = 3.0;
/// Step of a segment of an arm that moves, deg.
const MOVES: f64 = 2.0;

/// Headings and bend angles at the end of the last step.
#[derive(Debug, Clone, Copy)]
struct At {
    time_s: f64,
    heading: [f64; MAX_SEGMENTS],
    theta: [f64; MAX_SEGMENTS],
    bend: [[f64; 2]; MAX_SEGMENTS],
    counts: [[f64; 2]; MAX_SEGMENTS],
    imus: [Option<ImuReading>; MAX_SEGMENTS],
    bend_heading: [f64; MAX_SEGMENTS],
}

impl At {
    fn of(frame: &Frame) -> Self {
        let counts = frame.counts.map(|pair| pair.map(|counts| counts.map_or(f64::NAN, f64::from)));
        let Frame { time_s, heading, theta, bend, imus, bend_heading, .. } = *frame;
        Self { time_s, heading, theta, bend, counts, imus, bend_heading }
    }
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    facts: Facts,
    pub plugs: Plugs,
    quaternions: Quaternions,
    /// IMUs that were not read, or have jumped, since the last step.
    broken: [bool; MAX_SEGMENTS],
    at: Option<At>,
    moments: Moments,
    exchanges: Exchanges,
}

impl Steps {
    pub fn new(segments: usize, plugs: Plugs) -> Self {
        Self {
            facts: Facts {
                segments,
                rows: Rows::default(),
                largest: [0.0; MAX_SEGMENTS],
                places: [[0.0; 5]; MAX_SEGMENTS],
            },
            plugs,
            quaternions: Quaternions::new(),
            broken: [false; MAX_SEGMENTS],
            at: None,
            moments: Moments::ZERO,
            exchanges: Exchanges::new(segments),
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        self.facts.rows.add(frame);
        self.plugs.update(frame);
        self.exchanges.update(frame);
        self.facts.largest.iter_mut().zip(frame.reading).for_each(|(largest, reading)| *largest = largest.max(reading));
        let Some(from) = self.at.filter(|_| !frame.starts) else {
            self.at = Some(At::of(frame));
            return;
        };
        self.broken.iter_mut().zip(frame.broken).for_each(|(broken, now)| *broken |= now);
        let seconds = frame.time_s - from.time_s;
        if seconds < INTERVAL_S {
            return;
        }
        let at = At::of(frame);
        if seconds <= LONGEST_S {
            self.add(&from, &at);
        }
        self.broken = [false; MAX_SEGMENTS];
        self.at = Some(at);
    }

    fn add(&mut self, from: &At, to: &At) {
        let heading: [f64; MAX_SEGMENTS] =
            std::array::from_fn(|i| if self.broken[i] { f64::NAN } else { to.heading[i] - from.heading[i] });
        let theta: [f64; MAX_SEGMENTS] = std::array::from_fn(|i| to.theta[i] - from.theta[i]);
        let by_imu: [f64; MAX_SEGMENTS] = std::array::from_fn(|i| difference(&heading, i));
        // The noise of an arm at rest would hide the few swings of a long session.
        if !by_imu.iter().chain(&theta).any(|step| step.abs() >= MOVES) {
            return;
        }
        let counts = std::array::from_fn(|i| [0, 1].map(|place| to.counts[i][place] - from.counts[i][place]));
        self.plugs.add(&counts, &by_imu);
        let bend_heading = std::array::from_fn(|i| to.bend_heading[i] - from.bend_heading[i]);
        self.quaternions.add(&from.imus, &to.imus, &bend_heading);
        self.moments.add(self.facts.segments, &heading, &theta);
        self.exchanges.add(&heading, &theta);
        for i in 0..self.facts.segments {
            let by_imu = by_imu[i];
            let [a, b] = [0, 1].map(|place| to.bend[i][place] - from.bend[i][place]);
            let products = [a * a, b * b, a * by_imu, b * by_imu, by_imu * by_imu];
            for (sum, product) in self.facts.places[i].iter_mut().zip(products) {
                *sum += if product.is_nan() { 0.0 } else { product };
            }
        }
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        self.quaternions.finish(self.facts.rows, findings);
        self.exchanges.finish(findings);
        let fit = Fit::new(&self.moments, self.facts.segments, |i| is_unblamed(findings, i));
        Judge { fit, facts: &self.facts }.run(findings);
    }
}
