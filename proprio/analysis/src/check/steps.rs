//! Steps of the IMUs against those of the bend sensors, over a second: exchanged plugs, an inverted IMU, another unit, an IMU
//! that shows no heading.
//!
//! The steps' second moments are summed, so that any wiring can be judged at the end: θ_imu,i = g_i h_i − g_{i−1} h_{i−1} with
//! gains g and channels in any order. The misfit of a segment is q = E(Δθ_imu − Δθ_bend)² / (E Δθ_imu² + E Δθ_bend²): 0 for
//! equal steps, 1 for unrelated ones, 2 for opposite ones.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::ImuReading;

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed, is_imu_blamed};
use super::frame::{Frame, difference};
use super::plugs::Plugs;
use super::quaternions::Quaternions;
use super::wiring::{Fault, Wiring};

/// Shortest and longest interval of a step, s. Sessions at less than 1 Hz have their own interval.
const INTERVAL_S: f64 = 0.999;
const LONGEST_S: f64 = 3.0;
/// Least number of steps.
const STEPS: f64 = 20.0;
/// Least root mean square of a segment's steps, deg; its square is added to the denominator of q.
const MOTION: f64 = 2.0;
/// Misfit above which a segment's sensors disagree.
const MISFIT: f64 = 0.6;
/// Misfit below which a supposed fault explains a segment.
const EXPLAINED: f64 = 0.35;
/// Gains of an IMU outside which its scale is wrong.
const GAINS: [f64; 2] = [0.6, 1.6];
/// Largest heading in radians.
const WHOLE_TURN_RAD: f64 = 6.284;
/// Correlation from which on two sensors agree, and size from which on they follow one another.
const AGREES: f64 = 0.4;
const FOLLOWS: f64 = 0.75;

type Matrix = [[f64; MAX_SEGMENTS]; MAX_SEGMENTS];

const ZERO: Matrix = [[0.0; MAX_SEGMENTS]; MAX_SEGMENTS];

/// Sums of products, and their number.
#[derive(Debug, Clone)]
struct Moments {
    sum: Matrix,
    count: Matrix,
}

impl Moments {
    fn add(&mut self, i: usize, j: usize, product: f64) {
        if !product.is_nan() {
            self.sum[i][j] += product;
            self.count[i][j] += 1.0;
        }
    }

    fn mean(&self) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| self.sum[i][j] / self.count[i][j].max(1.0)))
    }
}

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

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    segments: usize,
    pub plugs: Plugs,
    quaternions: Quaternions,
    /// IMUs that were not read, or have jumped, since the last step.
    broken: [bool; MAX_SEGMENTS],
    at: Option<At>,
    rows: Rows,
    /// Largest heading of each IMU as it was read, deg.
    largest: [f64; MAX_SEGMENTS],
    /// Steps of IMUs by steps of IMUs, of IMUs by bend angles, of bend angles.
    imu_imu: Moments,
    imu_bend: Moments,
    bend_bend: Moments,
    /// By segment: squares of a and of b, their product with θ_imu, the square of θ_imu.
    places: [[f64; 5]; MAX_SEGMENTS],
}

impl Steps {
    pub fn new(segments: usize, plugs: Plugs) -> Self {
        let moments = Moments { sum: ZERO, count: ZERO };
        Self {
            segments,
            plugs,
            quaternions: Quaternions::new(),
            broken: [false; MAX_SEGMENTS],
            at: None,
            rows: Rows::default(),
            largest: [0.0; MAX_SEGMENTS],
            imu_imu: moments.clone(),
            imu_bend: moments.clone(),
            bend_bend: moments,
            places: [[0.0; 5]; MAX_SEGMENTS],
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        self.rows.add(frame);
        self.plugs.update(frame);
        self.largest.iter_mut().zip(frame.reading).for_each(|(largest, reading)| *largest = largest.max(reading));
        let counts = frame.counts.map(|pair| pair.map(|counts| counts.map_or(f64::NAN, f64::from)));
        let Frame { time_s, heading, theta, bend, imus, bend_heading, .. } = *frame;
        let at = At { time_s, heading, theta, bend, counts, imus, bend_heading };
        let Some(from) = self.at.as_ref().filter(|_| !frame.starts) else {
            self.at = Some(at);
            return;
        };
        self.broken.iter_mut().zip(frame.broken).for_each(|(broken, now)| *broken |= now);
        let seconds = at.time_s - from.time_s;
        if seconds < INTERVAL_S {
            return;
        }
        if seconds <= LONGEST_S {
            self.add(&from.clone(), &at);
        }
        self.broken = [false; MAX_SEGMENTS];
        self.at = Some(at);
    }

    fn add(&mut self, from: &At, to: &At) {
        let heading: [f64; MAX_SEGMENTS] =
            std::array::from_fn(|i| if self.broken[i] { f64::NAN } else { to.heading[i] - from.heading[i] });
        let theta: [f64; MAX_SEGMENTS] = std::array::from_fn(|i| to.theta[i] - from.theta[i]);
        let by_imu = std::array::from_fn(|i| difference(&heading, i));
        let counts = std::array::from_fn(|i| [0, 1].map(|place| to.counts[i][place] - from.counts[i][place]));
        self.plugs.add(&counts, &by_imu);
        let bend_heading = std::array::from_fn(|i| to.bend_heading[i] - from.bend_heading[i]);
        self.quaternions.add(&from.imus, &to.imus, &bend_heading);
        for i in 0..self.segments {
            for j in 0..self.segments {
                self.imu_bend.add(i, j, heading[i] * theta[j]);
                if j <= i {
                    self.imu_imu.add(i, j, heading[i] * heading[j]);
                    self.bend_bend.add(i, j, theta[i] * theta[j]);
                }
            }
            let by_imu = by_imu[i];
            let [a, b] = [0, 1].map(|place| to.bend[i][place] - from.bend[i][place]);
            let products = [a * a, b * b, a * by_imu, b * by_imu, by_imu * by_imu];
            for (sum, product) in self.places[i].iter_mut().zip(products) {
                *sum += if product.is_nan() { 0.0 } else { product };
            }
        }
    }

    pub fn finish(&self, findings: &mut Vec<Finding>) {
        self.quaternions.finish(self.rows, findings);
        Judge::new(self, findings).run(self, findings);
    }
}

/// Mean products of the steps, and the segments that can be judged.
struct Judge {
    imu_imu: Matrix,
    imu_bend: Matrix,
    bend_bend: Matrix,
    segments: Vec<usize>,
}

impl Judge {
    fn new(steps: &Steps, findings: &[Finding]) -> Self {
        let half = steps.imu_imu.mean();
        let imu_imu = std::array::from_fn(|i| std::array::from_fn(|j| half[i.max(j)][i.min(j)]));
        let mut judge =
            Self { imu_imu, imu_bend: steps.imu_bend.mean(), bend_bend: steps.bend_bend.mean(), segments: Vec::new() };
        let has_steps = |i: usize| {
            let before = i.checked_sub(1).map_or(STEPS, |before| steps.imu_bend.count[before][i]);
            steps.imu_bend.count[i][i].min(before) >= STEPS
        };
        let can_be_judged = |i: &usize| {
            let are_blamed = is_imu_blamed(findings, i + 1)
                || *i > 0 && is_imu_blamed(findings, *i)
                || is_bend_blamed(findings, i + 1);
            has_steps(*i) && judge.bend_bend[*i][*i] >= MOTION * MOTION && !are_blamed
        };
        judge.segments = (0..steps.segments).filter(can_be_judged).collect();
        judge
    }

    /// Mean square of a segment's step by its IMUs, and its product with the step by the bend sensors.
    fn by_imus(&self, wiring: &Wiring, i: usize) -> [f64; 2] {
        let (own, bend) = (wiring.imu[i], wiring.bend[i]);
        let gain = wiring.gain[own];
        let [mut square, mut product] = [gain * gain * self.imu_imu[own][own], gain * self.imu_bend[own][bend]];
        if let Some(before) = i.checked_sub(1).map(|before| wiring.imu[before]) {
            let gain_before = wiring.gain[before];
            square +=
                gain_before * (gain_before * self.imu_imu[before][before] - 2.0 * gain * self.imu_imu[own][before]);
            product -= gain_before * self.imu_bend[before][bend];
        }
        [square, wiring.bend_sign[i] * product]
    }

    fn misfit(&self, wiring: &Wiring, i: usize) -> f64 {
        let [square, product] = self.by_imus(wiring, i);
        let bend = self.bend_bend[wiring.bend[i]][wiring.bend[i]];
        (square - 2.0 * product + bend) / (square + bend + MOTION * MOTION)
    }

    fn misfits(&self, wiring: &Wiring) -> f64 {
        self.segments.iter().map(|i| self.misfit(wiring, *i)).sum()
    }

    /// True where this segment and the next one together fit the IMUs before and behind them, without the IMU between them.
    fn fits_without(&self, i: usize) -> bool {
        let next = i + 1;
        if !self.segments.contains(&next) {
            return false;
        }
        let product = |imu: usize| self.imu_bend[imu][i] + self.imu_bend[imu][next];
        let (mut square, mut both) = (self.imu_imu[next][next], product(next));
        if let Some(before) = i.checked_sub(1) {
            square += self.imu_imu[before][before] - 2.0 * self.imu_imu[next][before];
            both -= product(before);
        }
        let bend = self.bend_bend[i][i] + self.bend_bend[next][next] + 2.0 * self.bend_bend[next][i];
        (square - 2.0 * both + bend) / (square + bend + MOTION * MOTION) < EXPLAINED
    }

    /// The gain of all IMUs by which they fit best.
    fn common_gain(&self, wiring: &Wiring) -> f64 {
        let [square, product] = self.sum_by_imus(wiring, &self.segments);
        product / square
    }

    /// Sums of [`Self::by_imus`] over these segments.
    fn sum_by_imus(&self, wiring: &Wiring, segments: &[usize]) -> [f64; 2] {
        let each = segments.iter().map(|i| self.by_imus(wiring, *i));
        each.fold([0.0; 2], |sum, [square, product]| [sum[0] + square, sum[1] + product])
    }

    /// The gain of one IMU by which its heading fits the bend angles up to it best.
    fn gain(&self, i: usize) -> f64 {
        let product: f64 = (0..=i).map(|j| self.imu_bend[i][j]).sum();
        product / self.imu_imu[i][i]
    }

    fn faults(&self, wiring: &Wiring) -> Vec<Fault> {
        let mut faults = vec![Fault::Gain(None, self.common_gain(wiring))];
        let last = self.segments.last().map_or(0, |last| last + 1);
        faults.extend((0..last).map(|i| Fault::Gain(Some(i), self.gain(i) / wiring.gain[i])));
        faults.extend(self.segments.iter().map(|i| Fault::BendSign(*i)));
        for i in 0..last {
            faults.extend((0..i).flat_map(|j| [Fault::Imus(j, i), Fault::Bends(j, i)]));
        }
        faults
    }

    fn run(&self, steps: &Steps, findings: &mut Vec<Finding>) {
        self.radians(steps, findings);
        if findings.iter().any(|found| found.kind == Kind::Radians) {
            return;
        }
        self.lone_sensors(steps, findings);
        let judged: Vec<usize> = self.segments.iter().copied().filter(|i| !is_bend_blamed(findings, i + 1)).collect();
        let wiring = self.explain(steps, &judged, findings);
        self.report_unexplained(steps, &wiring, &self.bad(&judged, &wiring), findings);
    }

    /// Finds IMUs in radians: no heading is above a whole turn in them, and the segments on either side of the IMU disagree.
    fn radians(&self, steps: &Steps, findings: &mut Vec<Finding>) {
        let in_order = Wiring::in_order();
        let disagrees = |i: usize| self.segments.contains(&i) && self.misfit(&in_order, i) > MISFIT;
        let is_small = |i: usize| (f64::MIN_POSITIVE..=WHOLE_TURN_RAD).contains(&steps.largest[i]);
        let imus: Vec<usize> =
            (0..steps.segments).filter(|i| is_small(*i) && (disagrees(*i) || disagrees(i + 1))).collect();
        let figure = |imus: &[usize]| imus.iter().map(|i| steps.largest[*i]).fold(0.0, f64::max);
        let (rows, kind) = (steps.rows, Kind::Radians);
        if imus.len() > 1 && (0..steps.segments).all(is_small) {
            findings.push(Finding { sensor: Source::AllImus, rows, kind, figure: figure(&imus) });
        } else {
            let found =
                |i: &usize| Finding { sensor: Source::Imu { segment: i + 1 }, rows, kind, figure: figure(&[*i]) };
            findings.extend(imus.iter().map(found));
        }
    }

    /// The segments of these whose sensors disagree.
    fn bad(&self, judged: &[usize], wiring: &Wiring) -> Vec<usize> {
        judged.iter().copied().filter(|i| self.misfit(wiring, *i) > MISFIT).collect()
    }

    /// Supposes the fault that explains most, as long as one explains a segment; returns the wiring with all of them.
    fn explain(&self, steps: &Steps, judged: &[usize], findings: &mut Vec<Finding>) -> Wiring {
        let mut wiring = Wiring::in_order();
        loop {
            let now = self.bad(judged, &wiring);
            if now.is_empty() {
                return wiring;
            }
            let is_allowed = |fault: &Fault| match fault {
                Fault::Gain(_, gain) => gain.is_finite() && !(GAINS[0]..=GAINS[1]).contains(gain),
                _ => true,
            };
            let cost = |fault: &Fault| self.misfits(&wiring.with(*fault));
            let best = self.faults(&wiring).into_iter().filter(is_allowed).min_by(|a, b| cost(a).total_cmp(&cost(b)));
            let Some(fault) = best else { return wiring };
            let then = wiring.with(fault);
            let explains =
                now.iter().any(|i| self.misfit(&then, *i) < EXPLAINED) && self.bad(judged, &then).len() < now.len();
            if !explains {
                return wiring;
            }
            let explained = 100.0 * (1.0 - self.misfits(&then) / self.misfits(&wiring));
            self.report(steps, fault, explained, findings);
            wiring = then;
        }
    }

    /// Reports the segments that no fault of the wiring explains: all of them by one cause, or each.
    fn report_unexplained(&self, steps: &Steps, wiring: &Wiring, bad: &[usize], findings: &mut Vec<Finding>) {
        if bad.len() == self.segments.len() && bad.len() > 1 {
            let [square, product] = self.sum_by_imus(wiring, bad);
            let bend: f64 = bad.iter().map(|i| self.bend_bend[*i][*i]).sum();
            let correlation = 100.0 * product / (square * bend).sqrt().max(f64::MIN_POSITIVE);
            let (rows, kind) = (steps.rows, Kind::Unrelated);
            findings.push(Finding { sensor: Source::AllImus, rows, kind, figure: correlation });
            return;
        }
        for i in bad {
            let source = Source::Imu { segment: *i };
            let is_before_unrelated =
                findings.iter().any(|found| found.sensor == source && found.kind == Kind::Unrelated);
            if !is_before_unrelated {
                self.blame(steps, *i, bad.contains(&(i + 1)) || *i + 1 == steps.segments, findings);
            }
        }
    }

    fn report(&self, steps: &Steps, fault: Fault, explained: f64, findings: &mut Vec<Finding>) {
        let (sensor, kind, figure) = match fault {
            Fault::Gain(imu, gain) => {
                let sensor = imu.map_or(Source::AllImus, |i| Source::Imu { segment: i + 1 });
                (sensor, if gain < 0.0 { Kind::Inverted } else { Kind::Scale }, gain.recip())
            }
            Fault::Imus(i, j) => (Source::TwoImus { segment: i + 1, other: j + 1 }, Kind::Exchanged, explained),
            Fault::Bends(i, j) => (Source::TwoBends { segment: i + 1, other: j + 1 }, Kind::Exchanged, explained),
            Fault::BendSign(i) => return self.blame(steps, i, false, findings),
        };
        findings.push(Finding { sensor, rows: steps.rows, kind, figure });
    }

    /// Finds bend sensors that do not follow the IMUs while their twins do.
    fn lone_sensors(&self, steps: &Steps, findings: &mut Vec<Finding>) {
        for i in &self.segments {
            let correlations = correlations(&steps.places[*i]);
            for place in 0..2 {
                if correlations[place] < AGREES && correlations[1 - place] > FOLLOWS {
                    let sensor = Source::Bend { segment: i + 1, place };
                    let figure = 100.0 * correlations[place];
                    findings.push(Finding { sensor, rows: steps.rows, kind: Kind::Unrelated, figure });
                }
            }
        }
    }

    /// Finds the sensor of a segment in which no supposed fault of the wiring explains the misfit. An IMU is in the next segment,
    /// too.
    fn blame(&self, steps: &Steps, i: usize, next_is_bad: bool, findings: &mut Vec<Finding>) {
        let correlations = correlations(&steps.places[i]);
        let rows = steps.rows;
        if (next_is_bad || self.fits_without(i)) && correlations.iter().all(|correlation| correlation.abs() < FOLLOWS) {
            let figure = 100.0 * correlations[0];
            findings.push(Finding { sensor: Source::Imu { segment: i + 1 }, rows, kind: Kind::Unrelated, figure });
            return;
        }
        for (place, correlation) in correlations.into_iter().enumerate() {
            if correlation < AGREES {
                let kind = if correlation < -FOLLOWS { Kind::Inverted } else { Kind::Unrelated };
                let figure = if kind == Kind::Inverted { correlation } else { 100.0 * correlation };
                findings.push(Finding { sensor: Source::Bend { segment: i + 1, place }, rows, kind, figure });
            }
        }
    }
}

/// Correlations of the steps of a segment's bend sensors with those of its IMUs.
fn correlations([a, b, a_imu, b_imu, imu]: &[f64; 5]) -> [f64; 2] {
    [a_imu / (a * imu).sqrt(), b_imu / (b * imu).sqrt()]
}
