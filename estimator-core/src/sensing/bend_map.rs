//! V–Orient map: ADC counts of a bend sensor to the bend angle of its segment (paper, eq. 1, or a piecewise linear
//! curve).

use crate::config::{BendMap, CurveMap, KNOTS, QuadraticMap};
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::{Constant, Scalar};

/// Volts of one ADC count: 3.3 V over 12 bits.
pub const VOLTS_PER_COUNT: f64 = 3.3 / 4095.0;

/// A whole turn and a margin for rounding, rad.
const BEYOND_A_TURN: Constant = Constant::new(6.3);

/// Just under the ±32 of [`FusedOps::eval_quadratic`].
const LARGEST: f64 = 31.9;

/// Largest reading of a 12-bit ADC.
const MAX_COUNTS: u16 = 4095;

/// Counts from either end of the ADC's range that indicate an open or shorted sensor.
const RAIL_COUNTS: u16 = 10;

/// Extrapolation of a curve at either end, as a share of the calibrated range.
const EXTRAPOLATED: f64 = 0.25;

impl<S: FusedOps> BendMap<S> {
    /// Bend angle at `counts`, rad; `None` if `counts` are no valid reading of this sensor.
    ///
    /// ```
    /// use estimator_core::{BendMap, QuadraticMap};
    ///
    /// let map = BendMap::Quadratic(QuadraticMap::<f64>::from_volts(0.1, 0.5, -1.0, [0.5, 2.5]));
    /// let volts = 2000.0 * 3.3 / 4095.0;
    /// let angle = map.angle(2000).expect("a reading in the middle of the range");
    /// assert!((angle - (0.1 * volts * volts + 0.5 * volts - 1.0)).abs() < 1e-12);
    /// ```
    #[inline]
    #[must_use]
    pub fn angle(&self, counts: u16) -> Option<S> {
        match self {
            Self::Quadratic(map) => map.angle(counts),
            Self::Curve(map) => map.angle(counts),
        }
    }

    /// Returns `true` if `counts` are outside the range of the calibration sweep.
    #[must_use]
    pub fn is_extrapolated(&self, counts: u16) -> bool {
        match self {
            Self::Quadratic(_) => false,
            Self::Curve(CurveMap { calibrated: [lowest, highest], .. }) => counts < *lowest || counts > *highest,
        }
    }
}

impl<S: FusedOps> QuadraticMap<S> {
    /// Converts from the table's `c2` (rad/V²), `c1` (rad/V), `c0` (rad) and the range `volts` [lo, hi] of the fit.
    #[must_use]
    pub fn from_volts(c2: f64, c1: f64, c0: f64, volts: [f64; 2]) -> Self {
        let [lo, hi] = volts.map(|v| v / VOLTS_PER_COUNT);
        let center = f64::midpoint(lo, hi) as u16;
        let half_range = ((hi - lo) / 2.0) as u32;
        let shift = half_range.checked_next_power_of_two().map_or(0, u32::trailing_zeros).clamp(1, 12);
        let v0 = f64::from(center) * VOLTS_PER_COUNT;
        let scale = f64::from(1_u32 << shift) * VOLTS_PER_COUNT;
        let coefficients = [(c2 * v0 + c1) * v0 + c0, (2.0 * c2 * v0 + c1) * scale, c2 * scale * scale];
        let [_, b1, b2] = coefficients;
        let is_angle = |counts: &u16| {
            let v = f64::from(*counts) * VOLTS_PER_COUNT;
            let u = (v - v0) / scale;
            let fits = u.abs().max((b1 + b2 * u).abs()) < LARGEST;
            fits && ((c2 * v + c1) * v + c0).abs() <= core::f64::consts::TAU
        };
        let lowest = (0..=MAX_COUNTS).find(is_angle).unwrap_or(MAX_COUNTS);
        let highest = (0..=MAX_COUNTS).rev().find(is_angle).unwrap_or(0);
        let readable = [lowest, highest];
        Self { center, shift: shift as u8, coefficients: coefficients.map(S::from_f64), readable }
    }

    /// θ = b0 + b1 u + b2 u²; `None` where it is over a whole turn.
    #[inline]
    fn angle(&self, counts: u16) -> Option<S> {
        let [lowest, highest] = self.readable;
        if counts < lowest || counts > highest {
            return None;
        }
        let from_center = i32::from(counts) - i32::from(self.center);
        // Around the vertex of a parabola the angle may be over a turn again.
        S::eval_quadratic(from_center, u32::from(self.shift), &self.coefficients, BEYOND_A_TURN)
    }
}

impl<S: Scalar> CurveMap<S> {
    /// Samples a curve of bend angles (rad) at voltages that are evenly spaced from `volts[0]` to `volts[1]`, two at
    /// least.
    ///
    /// At both ends the curve is extrapolated linearly, with the slope of its outer eighth, by a quarter of the range.
    /// Further out, and within ten counts of the ADC's ends, counts are no valid reading.
    ///
    /// ```
    /// use estimator_core::{BendMap, CurveMap};
    ///
    /// let map = BendMap::Curve(CurveMap::<f64>::from_volts(&[-0.5, 0.0, 1.0], [1.0, 2.0]));
    /// let counts = |volts: f64| (volts / 3.3 * 4095.0) as u16;
    /// assert!((map.angle(counts(1.25)).expect("in the range") + 0.25).abs() < 2e-3);
    /// assert!((map.angle(counts(2.1)).expect("a little outside") - 1.2).abs() < 3e-3);
    /// assert!(map.is_extrapolated(counts(2.1)) && map.angle(counts(2.6)).is_none());
    /// ```
    #[must_use]
    pub fn from_volts(angles: &[f64], volts: [f64; 2]) -> Self {
        let [lo, hi] = volts.map(|v| v / VOLTS_PER_COUNT);
        let margin = EXTRAPOLATED * (hi - lo);
        let (first, last) = ((lo - margin).max(0.0) as u16, (hi + margin).min(f64::from(MAX_COUNTS)) as u16);
        let spacing = u32::from(last.saturating_sub(first)) / (KNOTS as u32 - 1) + 1;
        let shift = spacing.next_power_of_two().trailing_zeros();
        let knot = |k: usize| curve_at(angles, (f64::from(first) + (k << shift) as f64 - lo) / (hi - lo));
        Self {
            first,
            shift: shift as u8,
            knots: core::array::from_fn(|k| S::from_f64(knot(k).clamp(-LARGEST, LARGEST))),
            readable: [first.max(RAIL_COUNTS + 1), last.min(MAX_COUNTS - RAIL_COUNTS - 1)],
            calibrated: [(lo + 0.5) as u16, (hi + 0.5) as u16],
        }
    }

    /// Linear interpolation between the two knots around `counts`; `None` outside the readable range.
    #[inline]
    fn angle(&self, counts: u16) -> Option<S> {
        let [lowest, highest] = self.readable;
        if counts < lowest || counts > highest {
            return None;
        }
        let from_first = counts.wrapping_sub(self.first);
        let knot = usize::from(from_first.wrapping_shr(self.shift.into()));
        let (below, above) = (*self.knots.get(knot)?, *self.knots.get(knot + 1)?);
        let remainder = i32::from(from_first) & ((1 << (self.shift & 15)) - 1);
        Some(below + (above - below) * S::from_fraction(remainder, self.shift.into()))
    }
}

/// The curve at a share of its range, continued as straight lines beyond it.
fn curve_at(angles: &[f64], share: f64) -> f64 {
    let last = angles.len().saturating_sub(1);
    let (Some(first), Some(end)) = (angles.first(), angles.last()) else { return 0.0 };
    let outer = (last / 8).max(1).min(last);
    let place = share * last as f64;
    let slope = |near: f64, far: f64| (near - far) / outer.max(1) as f64;
    if place <= 0.0 {
        return first + slope(*angles.get(outer).unwrap_or(first), *first) * place;
    }
    if place >= last as f64 {
        return end + slope(*end, *angles.get(last - outer).unwrap_or(end)) * (place - last as f64);
    }
    let below = place as usize;
    let (Some(a), Some(b)) = (angles.get(below), angles.get(below + 1)) else { return *end };
    a + (b - a) * (place - below as f64)
}
