//! Updates of the model by scalar measurements.
//!
//! The states are updated at once, x = x⁻ + K ν. P = P⁻ − K (P⁻Hᵀ)ᵀ is quadratic in N; it is updated by block rows, of
//! which a sample can process one.

use crate::drift::bias_state::pending::CovarianceUpdate;
use crate::drift::bias_state::state::BiasState;
use crate::drift::bias_trace::{BiasMeasurement, BiasOperation, BiasTrace};
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::{Constant, Scalar};

/// Two variances below this add up in fixed point.
const HALF_OF_RANGE: Constant = Constant::new(15.5);
/// Smallest variance, 0.004° or 0.004° per time unit: rounding must not bring one to zero.
const SMALLEST: Constant = Constant::new(3e-7);

/// Variance S = H P⁻ Hᵀ of a scalar measurement's innovation, without the measurement noise.
#[derive(Debug, Clone, Copy)]
pub struct Innovation<S> {
    /// H P⁻ Hᵀ; saturated in fixed point.
    pub variance: S,
    /// An eighth of H P⁻ Hᵀ, which never saturates.
    eighth: S,
    measurement: BiasMeasurement,
}

fn eighth<S: Scalar>(value: S) -> S {
    value.half().half().half()
}

impl<S: FusedOps, const N: usize, T: BiasTrace<S>> BiasState<S, N, T> {
    /// Innovation of segment `i`'s bend sensors against its IMUs, H = (β_i: 1, β_{i−1}: −1, o_i: −1), for
    /// [`Self::update`].
    pub fn innovation(&mut self, i: usize) -> Innovation<S> {
        self.finish_update();
        let cross = &mut self.pending.cross;
        let below = i.checked_sub(1);
        if let Some([bias, _, offset]) = self.covariance.get(i) {
            let rows = bias.as_flattened().iter().zip(offset.as_flattened());
            for (cross, (bias, offset)) in cross.as_flattened_mut().iter_mut().zip(rows) {
                *cross = *bias - *offset;
            }
        }
        if let Some([bias, ..]) = below.and_then(|below| self.covariance.get(below)) {
            for (cross, bias) in cross.as_flattened_mut().iter_mut().zip(bias.as_flattened()) {
                *cross -= *bias;
            }
        }
        let [bias, _, offset] = cross.get(i).copied().unwrap_or([S::zero(); 3]);
        let of_below = below.and_then(|below| cross.get(below)).map_or(S::zero(), |[bias, ..]| *bias);
        let eighth = eighth(bias) - eighth(offset) - eighth(of_below);
        let measurement = BiasMeasurement::BendAngle { segment: i };
        Innovation { variance: bias - offset - of_below, eighth, measurement }
    }

    /// Innovation of heading `j`'s rate while the arm rests, H = (v_j: 1), for [`Self::update`].
    pub fn innovation_at_rest(&mut self, j: usize) -> Innovation<S> {
        self.finish_update();
        if let Some([_, rate, _]) = self.covariance.get(j) {
            self.pending.cross = *rate;
        }
        let variance = self.pending.cross.get(j).map_or(S::zero(), |[_, rate, _]| *rate);
        Innovation { variance, eighth: eighth(variance), measurement: BiasMeasurement::Rate { segment: j } }
    }

    /// K = P⁻Hᵀ/S, x = x⁻ + K ν, P = P⁻ − K (P⁻Hᵀ)ᵀ, for the newest innovation, its ν and measurement noise R.
    pub fn update(&mut self, innovation: Innovation<S>, nu: S, r: S) {
        self.begin_update(innovation, nu, r);
        self.finish_update();
    }

    /// Updates the states as [`Self::update`] does; P is updated by [`Self::update_row`].
    pub fn begin_update(&mut self, innovation: Innovation<S>, nu: S, r: S) {
        self.trace.record(BiasOperation::Update { measurement: innovation.measurement, nu, r });
        let CovarianceUpdate { gain, cross, rows_done } = &mut self.pending;
        *gain = *cross;
        *rows_done = 0;
        let half = S::constant(HALF_OF_RANGE);
        let s = if innovation.variance < half && r < half {
            innovation.variance + r
        } else {
            gain.as_flattened_mut().iter_mut().for_each(|gain| *gain = eighth(*gain));
            innovation.eighth + eighth(r)
        };
        S::divide_all(gain.as_flattened_mut(), s);
        let states = self.bias.iter_mut().zip(&mut self.rate).zip(&mut self.offset);
        for (((bias, rate), offset), [of_bias, of_rate, of_offset]) in states.zip(&*gain) {
            *bias = *bias + (*of_bias * nu).to_turns();
            *rate += *of_rate * nu;
            *offset += *of_offset * nu;
        }
    }

    /// Begins an update without effect: its block rows take as many samples as those of any other.
    pub fn begin_empty_update(&mut self) {
        self.finish_update();
        self.pending.gain.as_flattened_mut().fill(S::zero());
        self.pending.rows_done = 0;
    }

    /// Returns `true` while block rows of P remain to be updated.
    pub fn is_updating(&self) -> bool {
        self.pending.rows_done < N
    }

    /// Updates the next block row of P.
    pub fn update_row(&mut self) {
        let CovarianceUpdate { gain, cross, rows_done } = &mut self.pending;
        let Some(rows) = self.covariance.get_mut(*rows_done) else { return };
        let first = 3 * *rows_done;
        *rows_done += 1;
        let (gain, cross) = (gain.as_flattened(), cross.as_flattened());
        for (k, row) in (first..).zip(rows) {
            // Each pair of states uses K of the earlier one in both rows, which keeps P symmetric to the bit.
            let halves = row.as_flattened_mut().split_at_mut_checked(k);
            let (Some((before, after)), Some(gain_k), Some(cross_k)) = (halves, gain.get(k), cross.get(k)) else {
                return;
            };
            S::subtract_products(before, gain, *cross_k);
            S::subtract_products(after, cross.get(k..).unwrap_or_default(), *gain_k);
            if let Some(variance) = after.first_mut()
                && *variance < S::constant(SMALLEST)
            {
                *variance = S::constant(SMALLEST);
            }
        }
    }

    /// Updates all remaining block rows of P.
    pub fn finish_update(&mut self) {
        while self.is_updating() {
            self.update_row();
        }
    }
}
