//! Bend sensors by their counts, without the maps, which are wrong for them: exchanged plugs, and the counts of another ADC.

use calibration_tables::ArmFile;
use calibration_tables::MAX_SEGMENTS;

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed, is_imu_blamed};
use super::frame::{Decoder, Frame};
use super::median::median;
use super::tare::reference_angles;

/// Least number of steps in which the arm moves, and least root mean square of them, deg.
const STEPS: f64 = 10.0;
const MOTION: f64 = 2.0;
/// Correlation below which a sensor may follow another segment than its own, from which on it follows one, and by how much more
/// than its own.
const STRAYS: f64 = 0.7;
const FOLLOWS: f64 = 0.75;
const MORE: f64 = 0.25;
/// Least number of sensors by which a common factor is found.
const SENSORS: usize = 4;
/// Least size of the logarithm of a factor that is not 1.
const FACTOR: f64 = 0.15;
/// Largest difference of a sensor's factor from that of all, and share of the sensors that are within it.
const SPREAD: f64 = 0.15;
const SHARE: f64 = 0.75;
/// Largest logarithm of the ratio of the factors at rest and in motion: maps are curved.
const AGREES: f64 = 0.35;
/// Angle over which the slope of a map is taken, deg.
const SLOPE_DEG: f64 = 10.0;

/// Counts of a sensor by its map.
#[derive(Debug, Clone, Copy)]
struct Expected {
    /// In the reference pose.
    counts: f64,
    /// Counts per degree about it.
    slope: f64,
}

/// Counts of a sensor in the tare.
#[derive(Debug, Clone, Copy)]
pub(super) struct AtRest {
    /// Over those of the map.
    pub ratio: f64,
    /// Slope of the map over its counts, 1/deg.
    pub slope: f64,
}

/// Sums over the steps of a sensor's counts and of a segment's angle by the IMUs.
#[derive(Debug, Clone, Copy, Default)]
struct Products {
    counts: f64,
    both: f64,
    angle: f64,
    number: f64,
}

/// One bend sensor.
#[derive(Debug, Clone, Copy, Default)]
struct Plug {
    expected: Option<Expected>,
    /// Sum of the counts in tares, and their number.
    tare: [f64; 2],
    with: [Products; MAX_SEGMENTS],
}

/// The rules.
#[derive(Debug, Clone)]
pub(super) struct Plugs {
    segments: usize,
    tare_s: f64,
    tare_ends_s: f64,
    rows: Rows,
    /// By segment.
    pairs: Vec<[Plug; 2]>,
}

impl Plugs {
    pub fn new(table: &ArmFile, decoder: &Decoder) -> Self {
        let reference = reference_angles(table);
        let segments = table.segments.len();
        let plug = |i: usize, place: usize| {
            let expected = decoder.angles(i, place).and_then(|angles| Expected::of(angles, reference[i]));
            Plug { expected, ..Plug::default() }
        };
        Self {
            segments,
            tare_s: table.tare.seconds,
            tare_ends_s: f64::NEG_INFINITY,
            rows: Rows::default(),
            pairs: (0..segments).map(|i| [plug(i, 0), plug(i, 1)]).collect(),
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        self.rows.add(frame);
        if frame.starts {
            self.tare_ends_s = frame.time_s + self.tare_s;
        }
        if frame.time_s >= self.tare_ends_s {
            return;
        }
        for (plugs, counts) in self.pairs.iter_mut().zip(&frame.counts) {
            for (plug, counts) in plugs.iter_mut().zip(counts) {
                if let Some(counts) = counts {
                    plug.tare = [plug.tare[0] + f64::from(*counts), plug.tare[1] + 1.0];
                }
            }
        }
    }

    /// All rows.
    pub const fn rows(&self) -> Rows {
        self.rows
    }

    /// The counts of a sensor in the tare; `None` where it was not read there.
    pub fn at_rest(&self, i: usize, place: usize) -> Option<AtRest> {
        let plug = &self.pairs[i][place];
        let (ratio, expected) = plug.factor_at_rest().zip(plug.expected)?;
        Some(AtRest { ratio, slope: expected.slope / expected.counts })
    }

    /// Adds a step of the counts, and of the bend angles by the IMUs.
    pub fn add(&mut self, counts: &[[f64; 2]; MAX_SEGMENTS], by_imu: &[f64; MAX_SEGMENTS]) {
        for (plugs, counts) in self.pairs.iter_mut().zip(counts) {
            for (plug, counts) in plugs.iter_mut().zip(counts) {
                for (products, angle) in plug.with.iter_mut().zip(by_imu) {
                    products.add(*counts, *angle);
                }
            }
        }
    }

    pub fn finish(&self, findings: &mut Vec<Finding>) {
        if let Some(factor) = self.factor() {
            // Readings beyond an end of the ADC repeat its last value.
            findings.retain(|finding| !matches!(finding.sensor, Source::Bend { .. }));
            findings.push(Finding { sensor: Source::AllBend, rows: self.rows, kind: Kind::Counts, figure: factor });
            return;
        }
        self.exchanged(findings);
    }

    /// The factor of all counts to those by the maps, where it is not 1: by the counts of the reference pose, and by their change
    /// with the angle of the IMUs.
    fn factor(&self) -> Option<f64> {
        let plugs = || self.pairs.iter().enumerate().flat_map(|(i, plugs)| plugs.iter().map(move |plug| (i, plug)));
        let at_rest: Vec<f64> = plugs().filter_map(|(_, plug)| plug.factor_at_rest()).collect();
        let factor = common_factor(at_rest.clone())?;
        let agree = at_rest.iter().filter(|of| (*of / factor - 1.0).abs() < SPREAD).count();
        let in_motion = common_factor(plugs().filter_map(|(i, plug)| plug.factor_in_motion(i)).collect())?;
        let is_common = agree as f64 >= SHARE * at_rest.len() as f64 && (in_motion / factor).ln().abs() < AGREES;
        (is_common && factor.ln().abs() > FACTOR).then_some(factor)
    }

    /// Finds the pairs of sensors of which each follows the segment of the other and not its own.
    fn exchanged(&self, findings: &mut Vec<Finding>) {
        let is_seen = |i: usize| !is_imu_blamed(findings, i + 1) && (i == 0 || !is_imu_blamed(findings, i));
        let segments: Vec<usize> =
            (0..self.segments).filter(|i| is_seen(*i) && !is_bend_blamed(findings, i + 1)).collect();
        let follows = |i: usize, place: usize, j: usize| {
            let [own, other] = [i, j].map(|segment| self.correlation(i, place, segment));
            own.zip(other).is_some_and(|(own, other)| own < STRAYS && other > FOLLOWS.max(own + MORE))
        };
        let are = |(i, p): (usize, usize), (j, q): (usize, usize)| follows(i, p, j) && follows(j, q, i);
        let mut push = |sensor| {
            findings.push(Finding { sensor, rows: self.rows, kind: Kind::Exchanged, figure: 100.0 });
        };
        for (k, i) in segments.iter().copied().enumerate() {
            for j in segments[k + 1..].iter().copied() {
                if are((i, 0), (j, 0)) && are((i, 1), (j, 1)) {
                    push(Source::TwoBends { segment: i + 1, other: j + 1 });
                    continue;
                }
                let pairs = [(0, 0), (1, 1), (0, 1), (1, 0)];
                if let Some((p, q)) = pairs.into_iter().find(|(p, q)| are((i, *p), (j, *q))) {
                    push(Source::TwoPlugs { segments: [i + 1, j + 1], places: [p, q] });
                }
            }
        }
    }

    /// Size of the correlation of a sensor's steps with those of segment `j` by the IMUs; `None` without enough of them. Its sign
    /// is that of the sensor's divider.
    fn correlation(&self, i: usize, place: usize, j: usize) -> Option<f64> {
        let Products { counts, both, angle, .. } = *self.pairs[i][place].with[j].judged()?;
        Some(both.abs() / (counts * angle).sqrt().max(f64::MIN_POSITIVE))
    }
}

impl Expected {
    /// The counts by a map, given as the angle of every reading.
    fn of(angles: &[f32], reference: f64) -> Option<Self> {
        let nearest = |angle: f64| {
            let distance = |counts: &usize| (f64::from(angles[*counts]) - angle).abs();
            let known = (0..angles.len()).filter(|counts| !angles[*counts].is_nan());
            known.min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|counts| counts as f64)
        };
        let [lo, at, hi] = [-SLOPE_DEG, 0.0, SLOPE_DEG].map(|turn| nearest(reference + turn));
        Some(Self { counts: at?, slope: (hi? - lo?) / (2.0 * SLOPE_DEG) })
    }
}

impl Products {
    fn add(&mut self, counts: f64, angle: f64) {
        if !(counts + angle).is_nan() {
            self.counts += counts * counts;
            self.both += counts * angle;
            self.angle += angle * angle;
            self.number += 1.0;
        }
    }

    /// These sums, where there are enough steps with motion.
    fn judged(&self) -> Option<&Self> {
        (self.number >= STEPS && self.angle >= MOTION * MOTION * self.number).then_some(self)
    }
}

impl Plug {
    fn factor_at_rest(&self) -> Option<f64> {
        let [sum, number] = self.tare;
        self.expected.filter(|_| number > 0.0).map(|expected| sum / number / expected.counts)
    }

    fn factor_in_motion(&self, own: usize) -> Option<f64> {
        let Products { both, angle, .. } = *self.with[own].judged()?;
        self.expected.map(|expected| both / angle / expected.slope).filter(|factor| *factor > 0.0)
    }
}

/// The median factor of at least [`SENSORS`] sensors.
fn common_factor(factors: Vec<f64>) -> Option<f64> {
    if factors.len() < SENSORS { None } else { median(factors) }
}
