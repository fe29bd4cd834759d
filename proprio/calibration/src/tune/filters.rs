//! The estimator's own filters in dual numbers.

use estimator_core::{Angle, KalmanFilter, KalmanGains, KalmanParams, Pcc, Scalar, SegmentPose};
use nalgebra::{SVector, Vector2};

use super::Dual;
use super::parameters::PARAMETERS;
use super::sample::Measured;

/// KF_orient's and KF_coord's parameters of one segment, once for each derivative.
pub(super) type SegmentNoises = [[KalmanParams<Dual>; PARAMETERS]; 2];

/// Sums of derivatives by KF_orient's and KF_coord's parameters of one segment.
pub(super) type SegmentGradient = [[f64; PARAMETERS]; 2];

/// KF_orient and KF_coord of one segment.
#[derive(Debug, Clone)]
pub(super) struct Filters {
    pcc: Pcc<f64>,
    orient: Filter<1>,
    coord: Filter<2>,
}

/// One filter, once for each parameter, with the derivative of its state by that parameter.
#[derive(Debug, Clone)]
struct Filter<const D: usize> {
    gains: [KalmanGains<Dual>; PARAMETERS],
    blocks: [KalmanFilter<Dual, D>; PARAMETERS],
}

impl Filters {
    /// Filters that have not started.
    pub fn new(pcc: &Pcc<f64>, [orient, coord]: &SegmentNoises) -> Self {
        Self { pcc: *pcc, orient: Filter::new(orient), coord: Filter::new(coord) }
    }

    /// Takes one sample; returns the fused link.
    pub fn step(&mut self, measured: &Measured) -> Option<SegmentPose<f64>> {
        let links = [measured.imu_c, measured.bend].map(|theta| theta.map(|theta| self.pcc.link(Angle::from(theta))));
        let theta = self.orient.step(links.map(|link| link.map(|link| SVector::from([link.theta.remainder]))));
        let end = self.coord.step(links.map(|link| link.map(|link| link.end)));
        theta.zip(end).map(|(theta, end)| SegmentPose { theta: Angle::from(theta.x), end })
    }

    /// Adds the derivatives of a sum that changes by `by_theta` with the fused θ_i and by `by_end` with the fused P_i.
    pub fn add_derivatives(&self, by_theta: f64, by_end: Vector2<f64>, [orient, coord]: &mut SegmentGradient) {
        self.orient.add_derivatives(SVector::from([by_theta]), orient);
        self.coord.add_derivatives(by_end, coord);
    }
}

impl<const D: usize> Filter<D> {
    fn new(noises: &[KalmanParams<Dual>; PARAMETERS]) -> Self {
        Self { gains: noises.each_ref().map(KalmanGains::new), blocks: [KalmanFilter::new(); PARAMETERS] }
    }

    fn step(&mut self, measurements: [Option<SVector<f64, D>>; 2]) -> Option<SVector<f64, D>> {
        let [imu, bend] = measurements.map(|z| z.map(|z| z.map(Dual::from_f64)));
        for (block, gains) in self.blocks.iter_mut().zip(&self.gains) {
            block.step(gains, imu, bend);
        }
        let (state, _) = self.blocks[0].state()?;
        Some(state.map(Dual::to_f64))
    }

    fn add_derivatives(&self, by_state: SVector<f64, D>, sums: &mut [f64; PARAMETERS]) {
        for (sum, block) in sums.iter_mut().zip(&self.blocks) {
            if let Some((state, _)) = block.state() {
                *sum += state.map(Dual::derivative).dot(&by_state);
            }
        }
    }
}
