//! The smoothed shape of a row and its uncertainty.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{
    Angle, ArmConfig, FusedOps, Pcc, Q, Shape, ShapeUncertainty, Uncertainties, VARIANCE_SCALE, forward_kinematics,
};
use nalgebra::DMatrix;

/// Smoothed shape of one row.
#[derive(Debug, Clone)]
pub struct Smoothed<S> {
    /// The shape.
    pub shape: Shape<S, MAX_SEGMENTS>,
    /// Its uncertainty; empty where the table has no error sources.
    pub uncertainties: Uncertainties<MAX_SEGMENTS>,
}

/// Kinematics of an arm.
pub struct Kinematics<'t, S> {
    config: &'t ArmConfig<'t, S>,
    segments: Vec<Pcc<S>>,
}

impl<'t, S: FusedOps> Kinematics<'t, S> {
    pub fn new(config: &'t ArmConfig<'t, S>) -> Self {
        Self { config, segments: config.segments.iter().map(Pcc::new).collect() }
    }

    /// The fused shape with `corrections` of its bend angles, rad. `covariance` is that of the biases, rad², and `absence`
    /// the variance of headings that were not read.
    pub fn smoothed(
        &self,
        fused: &Shape<S, MAX_SEGMENTS>,
        corrections: &[f64],
        covariance: &DMatrix<f64>,
        absence: &[Q; MAX_SEGMENTS],
    ) -> Smoothed<S> {
        let links = fused.iter().zip(corrections).zip(&self.segments).map(|((segment, correction), pcc)| {
            let Angle { remainder, whole_turns } = segment.theta?;
            Some(pcc.link(Angle { remainder: remainder + S::from_f64(*correction), whole_turns }))
        });
        let shape: Shape<S, MAX_SEGMENTS> = forward_kinematics(links).collect();
        let uncertainties = self.uncertainties(&shape, covariance, absence);
        Smoothed { shape, uncertainties }
    }

    fn uncertainties(
        &self,
        shape: &Shape<S, MAX_SEGMENTS>,
        covariance: &DMatrix<f64>,
        absence: &[Q; MAX_SEGMENTS],
    ) -> Uncertainties<MAX_SEGMENTS> {
        let Some(sources) = &self.config.uncertainty else { return Uncertainties::new() };
        let share = sources.bias_share.to_f64() * VARIANCE_SCALE;
        let mut headings = [[Q::from_f64(0.0); MAX_SEGMENTS]; MAX_SEGMENTS];
        for (j, row) in headings.iter_mut().enumerate().take(covariance.nrows()) {
            for (k, value) in row.iter_mut().enumerate().take(covariance.ncols()) {
                *value = Q::from_f64(share * covariance[(j, k)]);
            }
            row[j] += sources.heading + absence[j];
        }
        let mut chain = ShapeUncertainty::<MAX_SEGMENTS>::new();
        let segments = shape.iter().zip(self.config.segments).zip(&headings).enumerate();
        let of_segment = |(i, ((shape, config), headings))| {
            chain.step(i, config, sources, shape, headings);
            *chain.of(i).expect("there is room")
        };
        segments.map(of_segment).collect()
    }
}
