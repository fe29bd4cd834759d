//! Whether the arm is in its reference pose, by the newest estimate.

use num_traits::Zero;

use super::Estimator;
use crate::drift::bias_trace::BiasTrace;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::Turns;
use crate::numeric::q::Q;
use crate::numeric::scalar::Scalar;
use crate::numeric::variance::scaled_square;

/// Stated standard deviations within which the tip is.
const DEVIATIONS: i32 = 3;

impl<S: FusedOps, const N: usize, const W: usize, T: BiasTrace<Q>> Estimator<'_, S, N, W, T> {
    /// Returns `true` if the tip of the newest shape is away from its place in the reference pose by more than three stated
    /// standard deviations. An arm that is tared so is bent, or its estimate was wrong. Always `false` with the
    /// moving-average anchor.
    ///
    /// The distance is that of small angles: each bend angle times its segment's distance from the tip.
    #[must_use]
    pub fn is_off_reference(&self) -> bool {
        let tip = self.segments.len().checked_sub(1).and_then(|tip| self.uncertainty.of(tip));
        let Some(covariance) = tip.and_then(|tip| tip.end) else { return false };
        let length = |i: usize| self.config.segments.get(i).map_or(Q::zero(), |of| of.length.to_q() + of.offset.to_q());
        let mut to_tip = (0..self.segments.len()).fold(Q::zero(), |sum, i| sum + length(i));
        let (mut distance, mut below) = (Q::zero(), Turns::ZERO);
        for (i, (segment, fused)) in self.config.segments.iter().zip(&self.corrected.fused).enumerate() {
            let Some(theta) = *fused else { return false };
            let excess = Q::from_phase((theta + below - segment.reference).phase());
            let half = length(i).half();
            distance += excess * (to_tip - half);
            to_tip = to_tip - half - half;
            below = segment.reference;
        }
        scaled_square(distance) > (covariance.xx + covariance.yy) * Q::from_int(DEVIATIONS * DEVIATIONS)
    }
}
