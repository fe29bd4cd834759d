//! Uncertainty of the fused shape, one segment after the other from the base to the tip.

use nalgebra::Vector2;

use crate::config::{SegmentConfig, UncertaintyConfig};
use crate::kinematics::covariance::{CovariancePropagation, lever_arm};
use crate::numeric::q::Q;
use crate::numeric::scalar::Scalar;
use crate::types::{SegmentShape, Uncertainty};

/// Uncertainties of the segments, and the state of their propagation along the chain.
#[derive(Debug, Clone)]
pub struct ShapeUncertainty<const N: usize> {
    propagation: CovariancePropagation<N>,
    /// End of the segment before; `None` where it is unknown.
    before: Option<Vector2<Q>>,
    newest: [Uncertainty; N],
}

impl<const N: usize> Default for ShapeUncertainty<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> ShapeUncertainty<N> {
    /// Before the first sample.
    pub const fn new() -> Self {
        let unknown = Uncertainty { theta: None, end: None };
        Self { propagation: CovariancePropagation::new(), before: None, newest: [unknown; N] }
    }

    /// Newest uncertainty of segment `i`.
    pub fn of(&self, i: usize) -> Option<&Uncertainty> {
        self.newest.get(i)
    }

    /// Propagates over segment `i`, which follows that of the last call or is the first: its `shape` and the covariance
    /// of its heading with all `headings`.
    pub fn step<S: Scalar>(
        &mut self,
        i: usize,
        config: &SegmentConfig<S>,
        sources: &UncertaintyConfig,
        shape: &SegmentShape<S>,
        headings: &[Q; N],
    ) {
        let Some(newest) = self.newest.get_mut(i) else { return };
        if i == 0 {
            self.propagation = CovariancePropagation::new();
            self.before = Some(Vector2::new(Q::from_bits(0), Q::from_bits(0)));
        }
        let end = shape.end.map(|end| Vector2::new(end.x.to_q(), end.y.to_q()));
        let chord = end.zip(self.before).map(|(end, before)| end - before);
        let theta = self.propagation.step(headings, chord.unwrap_or_default(), lever_arm(config), sources.end);
        let theta = shape.theta.map(|_| theta);
        *newest = Uncertainty { theta, end: theta.and(chord).map(|_| self.propagation.end()) };
        self.before = end.filter(|_| newest.end.is_some());
    }
}
