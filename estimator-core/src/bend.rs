//! V–Orient map: a bend sensor's ADC counts to the bend angle of its segment (paper, eq. 1).

use crate::scalar::{Constant, Scalar};

/// Volts of one ADC count: 3.3 V over 12 bits.
pub const VOLTS_PER_COUNT: f64 = 3.3 / 4095.0;

/// Over a whole turn by more than rounding, rad.
const BEYOND_A_TURN: Constant = Constant::new(6.3);

/// Just under the ±32 of [`Scalar::quadratic`].
const LARGEST: f64 = 31.9;

/// Largest reading of a 12-bit ADC.
const MAX_COUNTS: u16 = 4095;

/// Quadratic map θ = c2 V² + c1 V + c0 with V = counts · 3.3 / 4095, θ in rad.
///
/// Held about the middle of the sensor's own voltage range and scaled to it: θ = b0 + b1 u + b2 u² with
/// u = (counts − `center`) / 2^`shift` within ±1. So the coefficients stay as small as the angles themselves, where
/// c2, c1 and c0 of a sensor with a narrow range are large and cancel.
///
/// Counts at which the map passes a whole turn, such as those of an open or shorted sensor, are no reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendMap<S> {
    /// Counts in the middle of the calibrated range.
    pub center: u16,
    /// Binary logarithm of half the range in counts, rounded up.
    pub shift: u8,
    /// b0, b1, b2, rad.
    pub coefficients: [S; 3],
    /// Lowest and highest counts at which |θ| is within a whole turn, and u and b1 + b2 u in the range of
    /// [`Scalar::quadratic`].
    pub readable: [u16; 2],
}

impl<S: Scalar> BendMap<S> {
    /// From the table's `c2` (rad/V²), `c1` (rad/V), `c0` (rad) and the `volts` [lo, hi] that they were fitted on.
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

    /// Bend angle at `counts`, rad; `None` where it is over a whole turn.
    ///
    /// ```
    /// use estimator_core::BendMap;
    ///
    /// let map = BendMap::<f64>::from_volts(0.1, 0.5, -1.0, [0.5, 2.5]);
    /// let volts = 2000.0 * 3.3 / 4095.0;
    /// let angle = map.angle(2000).expect("a reading in the middle of the range");
    /// assert!((angle - (0.1 * volts * volts + 0.5 * volts - 1.0)).abs() < 1e-12);
    /// ```
    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    #[must_use]
    pub fn angle(&self, counts: u16) -> Option<S> {
        let [lowest, highest] = self.readable;
        if counts < lowest || counts > highest {
            return None;
        }
        let from_center = i32::from(counts) - i32::from(self.center);
        // Between the two branches of a map that turns back it may be over a turn again.
        S::quadratic(from_center, u32::from(self.shift), &self.coefficients, BEYOND_A_TURN)
    }
}
