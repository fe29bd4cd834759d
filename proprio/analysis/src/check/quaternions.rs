//! Quaternions in another order, and IMUs on their side.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Phase};

use super::finding::{Finding, Kind, Rows, Source, is_imu_blamed};
use super::frame::wrapped;

/// Least number of steps, and least root mean square of them, deg.
const STEPS: f64 = 20.0;
const MOTION: f64 = 2.0;
/// Correlation with the bend sensors below which a heading does not follow the arm, and from which on it does.
const UNRELATED: f64 = 0.4;
const FOLLOWS: f64 = 0.75;
/// Sine of the elevation of an IMU's x axis, from which on it has no good heading: 45°.
const STEEP: f64 = 0.707;
/// Units of 2⁻³⁰ in 1.
const ONE: f64 = 1_073_741_824.0;

/// Sums over the steps of one IMU.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    quaternions: f64,
    /// Size of the sine of the elevation of the IMU's x axis.
    elevation: f64,
    /// Squares of the steps and product with those of the bend sensors: of the heading as it is read, and of the heading by x, y,
    /// z, w.
    as_read: [f64; 2],
    by_xyzw: [f64; 2],
    bend: f64,
    steps: f64,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Quaternions([Sums; MAX_SEGMENTS]);

impl Quaternions {
    pub fn new() -> Self {
        Self([Sums::default(); MAX_SEGMENTS])
    }

    /// Adds a step of the readings, and of the headings by the bend sensors, deg.
    pub fn add(&mut self, from: &[Option<ImuReading>], to: &[Option<ImuReading>], bend: &[f64; MAX_SEGMENTS]) {
        for (sums, ((from, to), bend)) in self.0.iter_mut().zip(from.iter().zip(to).zip(bend)) {
            let (Some(ImuReading::Quaternion(from)), Some(ImuReading::Quaternion(to))) = (from, to) else { continue };
            sums.quaternions += 1.0;
            sums.elevation += elevation(to).abs();
            let by_xyzw = step(&as_xyzw(from), &as_xyzw(to));
            if !(by_xyzw + bend).is_nan() {
                // A reading without a heading does not follow the arm.
                let as_read = Some(step(from, to)).filter(|step| !step.is_nan()).unwrap_or(0.0);
                for (products, step) in [(&mut sums.as_read, as_read), (&mut sums.by_xyzw, by_xyzw)] {
                    *products = [products[0] + step * step, products[1] + step * bend];
                }
                sums.bend += bend * bend;
                sums.steps += 1.0;
            }
        }
    }

    pub fn finish(&self, rows: Rows, findings: &mut Vec<Finding>) {
        let read: Vec<(usize, &Sums)> = (1..)
            .zip(&self.0)
            .filter(|(segment, sums)| sums.quaternions >= STEPS && !is_imu_blamed(findings, *segment))
            .collect();
        let other: Vec<f64> = read.iter().filter_map(|(_, sums)| sums.other_order()).collect();
        if !other.is_empty() && 2 * other.len() >= read.len() {
            let figure = 100.0 * other.iter().sum::<f64>() / other.len() as f64;
            findings.push(Finding { sensor: Source::AllImus, rows, kind: Kind::QuaternionOrder, figure });
            return;
        }
        for (segment, sums) in read {
            let sine = sums.elevation / sums.quaternions;
            if sine > STEEP {
                let cosine = (1.0 - sine * sine).max(0.0).sqrt();
                let angle = Phase::atan2((sine * ONE) as i64, (cosine * ONE) as i64);
                let figure = angle.map_or(90.0, |angle| angle.rad().to_degrees());
                findings.push(Finding { sensor: Source::Imu { segment }, rows, kind: Kind::OnItsSide, figure });
            }
        }
    }
}

impl Sums {
    /// Correlation of the headings by x, y, z, w with the bend sensors, where they follow the arm and those by w, x, y, z do not.
    fn other_order(&self) -> Option<f64> {
        let is_judged = self.steps >= STEPS && self.bend >= MOTION * MOTION * self.steps;
        let correlation = |[square, product]: [f64; 2]| product / (square * self.bend).sqrt().max(f64::MIN_POSITIVE);
        let by_xyzw = correlation(self.by_xyzw);
        (is_judged && by_xyzw > FOLLOWS && correlation(self.as_read).abs() < UNRELATED).then_some(by_xyzw)
    }
}

/// Turn of the heading between two quaternions, deg; NaN where one has none.
fn step(from: &[i32; 4], to: &[i32; 4]) -> f64 {
    let [from, to] = [from, to].map(|quaternion| ImuReading::Quaternion(*quaternion).heading());
    from.zip(to).map_or(f64::NAN, |(from, to)| wrapped((to.rad() - from.rad()).to_degrees()))
}

/// A quaternion that was read as w, x, y, z, as x, y, z, w.
fn as_xyzw([x, y, z, w]: &[i32; 4]) -> [i32; 4] {
    [*w, *x, *y, *z]
}

/// Sine of the elevation of the IMU's x axis.
fn elevation(quaternion: &[i32; 4]) -> f64 {
    let [w, x, y, z] = quaternion.map(|part| f64::from(part) / ONE);
    2.0 * (x * z - w * y)
}
