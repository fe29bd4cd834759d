//! Steps of the bias filter that the backward pass undoes, and the log of its operations.

use estimator_core::{BiasMeasurement, BiasOperation, BiasTrace, Q};

/// States of an IMU and its segment.
pub const STATES: usize = 3;

/// Index of segment `i`'s bias β in the state vector.
pub const fn bias(i: usize) -> usize {
    STATES * i
}

/// Index of segment `i`'s rate v.
pub const fn rate(i: usize) -> usize {
    STATES * i + 1
}

/// Index of segment `i`'s offset o.
pub const fn offset(i: usize) -> usize {
    STATES * i + 2
}

/// Operations of the bias filter since the log was last emptied.
#[derive(Debug, Default)]
pub struct BiasLog(pub Vec<BiasOperation<Q>>);

impl BiasTrace<Q> for BiasLog {
    fn record(&mut self, operation: BiasOperation<Q>) {
        self.0.push(operation);
    }
}

/// Nonzero entries of a measurement's row H: index and value. Entries that a measurement lacks are zero.
pub type SparseRow = [(usize, f64); 3];

/// H of a measurement.
pub fn sparse_row(measurement: BiasMeasurement) -> SparseRow {
    match measurement {
        BiasMeasurement::BendAngle { segment: 0 } => [(bias(0), 1.0), (offset(0), -1.0), (bias(0), 0.0)],
        BiasMeasurement::BendAngle { segment: i } => [(bias(i), 1.0), (bias(i - 1), -1.0), (offset(i), -1.0)],
        BiasMeasurement::Rate { segment: j } => [(rate(j), 1.0), (rate(j), 0.0), (rate(j), 0.0)],
    }
}

/// A step of the filter with the values that the backward pass needs: process noise is in the gains.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A prior that depends on nothing before.
    Start,
    /// A: β ← β + v `dt`, o ← o · `decay`.
    Predict {
        /// The segment, from 0.
        segment: usize,
        /// Time, units of [`estimator_core::TIME_UNIT_S`].
        dt: f64,
        /// Factor of the offset.
        decay: f64,
    },
    /// An update by a scalar measurement.
    Update {
        /// H.
        row: SparseRow,
        /// K.
        gain: Vec<f64>,
        /// Innovation ν.
        nu: f64,
        /// Innovation variance S, rad².
        s: f64,
    },
}
