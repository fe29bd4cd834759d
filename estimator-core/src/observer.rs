//! Drift observer: what the IMUs say beyond the bend sensors, as a bias that drifts at a slowly changing rate.
//!
//! The anchor's moving average passes the bend sensors' hysteresis on; an average long enough to lose it would lag behind
//! the drift. A Kalman filter that knows the drift's rate can average over minutes without a lag. A third state, the slope,
//! is the part of the disagreement that is proportional to the bend: an error of a map's or a gyroscope's sensitivity,
//! which would pull the bias along wherever an arm leans to one side.
//!
//! z = θ_imu − θ_bend = b + s θ_bend + noise,  ḃ = v,  v̇ = white noise,  s nearly constant.
//!
//! All of it is whole numbers, the same for every number type: angles in units of 2⁻³² turns, covariances as shares of the
//! measurement's variance in units of 2⁻³⁰.

use crate::angle::Turns;
use crate::fixed::divide;

/// One in the units of covariances and gains.
const ONE: i32 = 1 << 30;

/// Variances are kept below this, so that sums of their products with θ, two quarter turns at most, fit 32 bits.
const LARGEST: i32 = ONE / 2;

/// Fractional bits that the bias has beyond those of [`Turns`], for steps that are smaller.
const FINE: u32 = 8;

/// How the drift is observed; the same for all segments.
///
/// Variances are shares of the measurement's, R, and all but the prior are for one value; the rate is per
/// [`RATE_S`](ObserverRule::RATE_S), the slope per quarter turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObserverRule {
    /// Time from value to value as a share of [`RATE_S`](ObserverRule::RATE_S), in units of 2⁻³².
    pub step: u32,
    /// Variances of bias, rate and slope at the start, in units of 2⁻³⁰.
    pub prior: [i32; 3],
    /// Growth of the variances of bias, rate and slope from value to value, in units of 2⁻³⁰.
    pub growth: [i32; 3],
    /// Disagreements that are off by more are left out,
    pub gate: Turns,
    /// until so many values in a row were.
    pub patience: u16,
    /// A step of the IMU from one value to the next that is no motion.
    pub jump: Turns,
    /// What is no motion yet.
    pub still: Turns,
    /// Variance of the bias below which an arm at rest teaches nothing, in units of 2⁻³⁰: that of the bend
    /// sensors' own error.
    pub doubt: i32,
}

impl ObserverRule {
    /// The time that rates are counted for, s: a power of two, and of the order in which drift changes.
    pub const RATE_S: f64 = 64.0;
}

/// What is known of one segment's drift.
///
/// ```
/// use estimator_core::{Disagreement, Observer, ObserverRule, Turns};
///
/// let degrees = |degrees: f64| Turns::from_rad(degrees.to_radians());
/// let rule = ObserverRule {
///     step: (0.1 / ObserverRule::RATE_S * 4_294_967_296.0) as u32, // 10 Hz
///     prior: [1 << 18, 1 << 25, 1 << 28],
///     growth: [0, 35, 1],
///     gate: degrees(8.0),
///     patience: 300,
///     jump: degrees(12.0),
///     still: degrees(1.0),
///     doubt: 1 << 23,
/// };
/// let mut observer = Observer::new(&rule);
/// for k in 0..6000 {
///     // Ten minutes of an IMU that drifts by 0.05° a second while the segment swings.
///     let (bend, drift) = (degrees(40.0 * f64::from(k % 100 - 50) / 50.0), degrees(0.005 * f64::from(k)));
///     observer.step(&rule, Some(Disagreement { imu: bend + drift, bend }));
/// }
/// assert!((observer.bias().rad().to_degrees() - 30.0).abs() < 0.1);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Observer {
    /// b, in units of 2⁻⁴⁰ turns.
    bias: i64,
    /// v for [`ObserverRule::RATE_S`], in units of 2⁻³² turns.
    rate: i32,
    /// s for a quarter turn, in units of 2⁻³² turns.
    slope: i32,
    covariance: Covariance,
    /// The value before, where there was one.
    before: Option<Disagreement>,
    /// The last value that told of motion, its IMU corrected.
    taught: Disagreement,
    /// Values in a row that were beyond the gate.
    gated: u16,
}

/// θ_imu and θ_bend of one segment, where both are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Disagreement {
    /// θ_imu, tared and unwrapped.
    pub imu: Turns,
    /// θ_bend.
    pub bend: Turns,
}

/// What a value is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum News {
    /// Both sensors have moved.
    Motion,
    /// The segment is where it was. The error of a bend sensor at rest stays what it was, too; to take it for news again and
    /// again would teach it to the bias.
    Rest,
    /// One sensor has moved and the other has not: it is stuck.
    Stuck,
}

/// The symmetric covariance of bias, rate and slope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Covariance {
    bias: i32,
    bias_rate: i32,
    bias_slope: i32,
    rate: i32,
    rate_slope: i32,
    slope: i32,
}

/// What a disagreement is worth to each state.
struct Gain {
    bias: i32,
    rate: i32,
    slope: i32,
}

impl Observer {
    /// An observer at the end of the tare, when the IMUs do not drift yet as far as anybody knows.
    #[must_use]
    pub const fn new(rule: &ObserverRule) -> Self {
        Self { covariance: Covariance::new(rule.prior), ..Self::idle() }
    }

    /// One that is never asked: the anchor corrects the drift.
    pub(crate) const fn idle() -> Self {
        let none = Disagreement { imu: Turns::ZERO, bend: Turns::ZERO };
        Self { bias: 0, rate: 0, slope: 0, covariance: Covariance::new([0; 3]), before: None, taught: none, gated: 0 }
    }

    /// The bias: what to subtract from θ_imu.
    #[must_use]
    pub const fn bias(&self) -> Turns {
        Turns::from_bits(self.bias.wrapping_add(1 << (FINE - 1)) >> FINE)
    }

    /// Variance of the bias, as a share of the measurement's, in units of 2⁻³⁰.
    #[must_use]
    pub const fn variance(&self) -> i32 {
        self.covariance.bias
    }

    /// Takes one value, the mean since the one before, or `None` where one of both sensors was not read.
    #[inline(never)]
    pub fn step(&mut self, rule: &ObserverRule, value: Option<Disagreement>) {
        self.bias = self.bias.wrapping_add((i64::from(self.rate) * i64::from(rule.step)) >> (32 - FINE));
        self.covariance.predict(rule);
        let Some(value) = value else {
            self.before = None;
            return;
        };
        self.follow_jump(rule, value);
        let bend = quarter_turns(value.bend);
        let innovation = value.imu - value.bend - self.bias() - Turns::from_bits(scaled(self.slope, bend).into());
        let news = self.news(rule, value);
        let teaches = match news {
            News::Motion => true,
            News::Rest => self.covariance.bias >= rule.doubt,
            News::Stuck => false,
        };
        if self.lets_pass(rule, innovation) && teaches {
            self.learn(bend, innovation.bits() as i32);
        }
    }

    /// x = x⁻ + K innovation. Out of line, where the compiler sees that both numbers have 32 bits.
    #[inline(never)]
    fn learn(&mut self, bend: i32, innovation: i32) {
        let gain = self.covariance.measure(bend);
        let innovation = i64::from(innovation);
        self.bias = self.bias.wrapping_add((i64::from(gain.bias) * innovation) >> (30 - FINE));
        self.rate = self.rate.saturating_add(rounded(i64::from(gain.rate) * innovation));
        self.slope = self.slope.saturating_add(rounded(i64::from(gain.slope) * innovation));
    }

    /// An IMU that steps by more than the arm can move, while the bend sensors do not, has lost its heading and not its drift.
    fn follow_jump(&mut self, rule: &ObserverRule, value: Disagreement) {
        if let Some(before) = self.before.replace(value) {
            let (imu, bend) = (value.imu - before.imu, value.bend - before.bend);
            let step = imu - bend;
            if imu.exceeds(rule.jump) && step.exceeds(rule.jump) && !bend.exceeds(rule.jump) {
                self.bias = self.bias.wrapping_add(step.bits() << FINE);
                self.covariance.bias = self.covariance.bias.max(rule.doubt);
            }
        }
    }

    /// What a value adds to the last one that taught something.
    fn news(&mut self, rule: &ObserverRule, value: Disagreement) -> News {
        let here = Disagreement { imu: value.imu - self.bias(), ..value };
        let (imu, bend) = (here.imu - self.taught.imu, here.bend - self.taught.bend);
        match (imu.exceeds(rule.still), bend.exceeds(rule.still)) {
            (true, true) => {
                self.taught = here;
                News::Motion
            }
            (true, false) if imu.exceeds(rule.gate) => News::Stuck,
            (false, true) if bend.exceeds(rule.gate) => News::Stuck,
            _ => News::Rest,
        }
    }

    /// Whether an innovation is within the gate. When none is for long, it is the bias that is wrong, and is doubted.
    fn lets_pass(&mut self, rule: &ObserverRule, innovation: Turns) -> bool {
        self.gated = if innovation.exceeds(rule.gate) { self.gated.saturating_add(1) } else { 0 };
        if self.gated > rule.patience {
            self.covariance.bias = self.covariance.bias.max(rule.doubt);
        }
        self.gated == 0 || self.gated > rule.patience
    }
}

impl Covariance {
    const fn new([bias, rate, slope]: [i32; 3]) -> Self {
        Self { bias, bias_rate: 0, bias_slope: 0, rate, rate_slope: 0, slope }
    }

    /// P⁻ = A P Aᵀ + Q. Where nothing was measured for so long that a variance comes to its limit, P stays as it is.
    fn predict(&mut self, rule: &ObserverRule) {
        let [bias, rate, slope] = rule.growth;
        let share = |value: i32| ((i64::from(value) * i64::from(rule.step) + (1 << 31)) >> 32) as i32;
        let by_rate = share(self.rate);
        let next = Self {
            bias: self.bias.saturating_add(2 * share(self.bias_rate) + share(by_rate) + bias),
            bias_rate: self.bias_rate.saturating_add(by_rate),
            bias_slope: self.bias_slope.saturating_add(share(self.rate_slope)),
            rate: self.rate.saturating_add(rate),
            rate_slope: self.rate_slope,
            slope: self.slope.saturating_add(slope),
        };
        if next.bias.max(next.rate).max(next.slope) < LARGEST {
            *self = next;
        }
    }

    /// K = P⁻Hᵀ/(H P⁻ Hᵀ + 1) and P = P⁻ − K H P⁻ for H = (1, 0, `bend`).
    fn measure(&mut self, bend: i32) -> Gain {
        let to_bias = self.bias + scaled(self.bias_slope, bend);
        let to_rate = self.bias_rate + scaled(self.rate_slope, bend);
        let to_slope = self.bias_slope + scaled(self.slope, bend);
        // In units of 2⁻²⁷: it comes to 10 at most.
        let expected = (i64::from(ONE) + i64::from(to_bias) + ((i64::from(to_slope) * i64::from(bend)) >> 30)) >> 3;
        let inverse = divide::<30>(1 << 27, expected as u32) as i32;
        let [bias, rate, slope] = [to_bias, to_rate, to_slope].map(|to| scaled(to, inverse));
        let gain = Gain { bias, rate, slope };
        self.bias -= scaled(gain.bias, to_bias);
        self.bias_rate -= scaled(gain.bias, to_rate);
        self.bias_slope -= scaled(gain.bias, to_slope);
        self.rate -= scaled(gain.rate, to_rate);
        self.rate_slope -= scaled(gain.rate, to_slope);
        self.slope -= scaled(gain.slope, to_slope);
        gain
    }
}

/// An angle within half a turn in quarter turns, in units of 2⁻³⁰: the same bits.
fn quarter_turns(angle: Turns) -> i32 {
    angle.bits().clamp(i64::from(-i32::MAX), i64::from(i32::MAX)) as i32
}

/// A product with a factor in units of 2⁻³⁰.
fn scaled(value: i32, factor: i32) -> i32 {
    rounded(i64::from(value) * i64::from(factor))
}

/// A product in units of 2⁻³⁰, rounded to whole ones.
fn rounded(product: i64) -> i32 {
    ((product + (1 << 29)) >> 30) as i32
}
