//! Trace of the bias filter: its linear operations on the states x and their covariance P, for a smoother on a host.
//!
//! The board has no trace. The default, the unit type, discards all operations and costs nothing.

/// A linear operation of [`BiasState`](crate::BiasState). Variances are multiplied by
/// [`VARIANCE_SCALE`](crate::VARIANCE_SCALE); `noise` is that of the bias, the rate and the offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BiasOperation<S> {
    /// Start: all states are zero with zero variance, except the biases, whose covariance is
    /// (1 + min(i, j)) · `straightness`.
    Start {
        /// Variance of each segment's bend angle in the reference pose.
        straightness: S,
    },
    /// Prediction of one segment: β ← β + v `dt`, o ← o · `decay`, P ← A P Aᵀ + `noise`.
    Predict {
        /// The segment, from 0.
        segment: usize,
        /// Time, units of [`TIME_UNIT_S`](crate::TIME_UNIT_S); zero where the bias follows the heading of an arm at
        /// rest.
        dt: S,
        /// Factor of the offset.
        decay: S,
        /// Process noise.
        noise: [S; 3],
    },
    /// Inflation of the variances of one segment's states: P ← P + `noise`.
    Noise {
        /// The segment, from 0.
        segment: usize,
        /// Process noise.
        noise: [S; 3],
    },
    /// Output: the states correct the headings of the sample.
    Output,
    /// Update: K = P⁻Hᵀ/(H P⁻ Hᵀ + `r`), x ← x⁻ + K `nu`, P ← P⁻ − K H P⁻.
    Update {
        /// H.
        measurement: BiasMeasurement,
        /// Innovation, rad, or rad per time unit.
        nu: S,
        /// Measurement noise.
        r: S,
    },
}

/// Row H of a scalar measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BiasMeasurement {
    /// Bend sensors against IMUs: (β_i: 1, β_{i−1}: −1, o_i: −1).
    BendAngle {
        /// i, from 0.
        segment: usize,
    },
    /// Change of a heading while the arm rests: (v_j: 1).
    Rate {
        /// j, from 0.
        segment: usize,
    },
}

/// Receiver of the operations, in their order.
pub trait BiasTrace<S>: Default {
    /// Records one operation.
    fn record(&mut self, operation: BiasOperation<S>);
}

impl<S> BiasTrace<S> for () {
    #[inline(always)]
    fn record(&mut self, _: BiasOperation<S>) {}
}
