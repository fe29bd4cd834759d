//! Outcome of one row: everything that the estimator computes from it.

use calibration_tables::{MAX_SEGMENTS, MAX_WINDOW};
use estimator_core::{BiasTrace, Conditions, Contacts, Estimate, Estimator, FusedOps, Method, Q, Shape, Uncertainties};
use proprio_session::Row;

use crate::smooth::Smoothed;

/// The estimator with room for every arm.
pub type HostEstimator<'t, S> = Estimator<'t, S, MAX_SEGMENTS, { MAX_WINDOW as usize }>;

/// Outcome of one row.
#[derive(Debug, Clone)]
pub struct Outcome<S> {
    /// The estimate.
    pub estimate: Estimate<S, MAX_SEGMENTS>,
    /// The shape by each of [`Method::ALL`].
    pub shapes: [Shape<S, MAX_SEGMENTS>; Method::ALL.len()],
    /// Uncertainty of the fused shape; empty where the table has no error sources.
    pub uncertainties: Uncertainties<MAX_SEGMENTS>,
    /// Contact of the segments.
    pub contacts: Contacts<MAX_SEGMENTS>,
    /// Conditions that make the estimate less certain, by segment.
    pub conditions: Conditions<MAX_SEGMENTS>,
    /// The smoothed shape, which uses the later readings too, where the session is [smoothed](crate::smooth).
    pub smoothed: Option<Smoothed<S>>,
}

impl<S: FusedOps> Outcome<S> {
    /// Runs the estimator for one row.
    ///
    /// # Panics
    /// If the estimator has no room for its own table.
    pub fn of_row<T: BiasTrace<Q>>(
        estimator: &mut Estimator<'_, S, MAX_SEGMENTS, { MAX_WINDOW as usize }, T>,
        row: &Row,
    ) -> Self {
        if row.starts {
            estimator.start().expect("the estimator has room for its table");
        }
        let estimate = estimator.update_full(&row.sample);
        let shapes = Method::ALL.map(|method| estimator.shape(&estimate, method));
        let (uncertainties, contacts) = (estimator.uncertainties(), estimator.contacts());
        Self { estimate, shapes, uncertainties, contacts, conditions: estimator.conditions(), smoothed: None }
    }
}
