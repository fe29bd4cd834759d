//! Second pass: forwards again, each block of rows smoothed from its end.

use std::vec::IntoIter;

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ArmConfig, BiasOperation, FusedOps, LONGEST_PREDICTION_US, Method, Q, TIME_UNIT_S};
use proprio_session::Row;

use super::adjoint::Adjoint;
use super::correction::{Correction, RowCovariance};
use super::covariance::CovarianceFilter;
use super::forward::{BLOCK_ROWS, TracedEstimator, traced};
use super::headings::{HeadingCorrections, Present};
use super::shape::{Kinematics, Smoothed};
use super::step::{Step, bias};
use crate::Outcome;

/// The pass over all rows after the [forward pass](super::ForwardPass) over the same.
pub struct SmoothingPass<'t, S> {
    estimator: Box<TracedEstimator<'t, S>>,
    covariance: CovarianceFilter,
    kinematics: Kinematics<'t, S>,
    adjoints: IntoIter<Adjoint>,
    predicted_at_us: Vec<u64>,
    steps: Vec<Step>,
    rows: Vec<BufferedRow<S>>,
    headings: HeadingCorrections,
    last_us: u64,
}

/// A row until its block is complete.
struct BufferedRow<S> {
    row: Row,
    outcome: Outcome<S>,
    absence: [Q; MAX_SEGMENTS],
    /// Number of the block's steps before the row's headings are corrected, and after the row; `None` before the end of the
    /// tare.
    output: Option<(usize, RowCovariance)>,
    end: usize,
}

impl<'t, S: FusedOps> SmoothingPass<'t, S> {
    /// Before the first row, with the adjoints of the [forward pass](super::ForwardPass::finish).
    #[must_use]
    pub fn new(config: &'t ArmConfig<'t, S>, adjoints: Vec<Adjoint>) -> Self {
        let segments = config.segments.len();
        Self {
            estimator: traced(config),
            covariance: CovarianceFilter::new(segments),
            kinematics: Kinematics::new(config),
            adjoints: adjoints.into_iter(),
            predicted_at_us: vec![0; segments],
            steps: Vec::new(),
            rows: Vec::new(),
            headings: HeadingCorrections::new(segments),
            last_us: 0,
        }
    }

    /// Takes a row; passes rows with their smoothed outcomes to `visit`, in their order, when their block is complete.
    ///
    /// # Errors
    /// Errors of `visit`.
    pub fn add<E>(&mut self, row: &Row, visit: &mut impl FnMut(&Row, &Outcome<S>) -> Result<(), E>) -> Result<(), E> {
        let outcome = Outcome::of_row(&mut self.estimator, row);
        let absence = self.estimator.absence_variances();
        let operations = std::mem::take(&mut self.estimator.trace_mut().0);
        let mut output = None;
        for operation in &operations {
            match operation {
                BiasOperation::Start { .. } => self.predicted_at_us.fill(row.sample.time_us),
                BiasOperation::Output => output = Some((self.steps.len(), self.row_covariance(row.sample.time_us))),
                BiasOperation::Predict { segment, .. } => self.predicted_at_us[*segment] = row.sample.time_us,
                BiasOperation::Noise { .. } | BiasOperation::Update { .. } => {}
            }
            self.steps.extend(self.covariance.apply(operation));
        }
        self.rows.push(BufferedRow { row: row.clone(), outcome, absence, output, end: self.steps.len() });
        if self.rows.len() == BLOCK_ROWS { self.end_block(visit) } else { Ok(()) }
    }

    /// Smooths the rows of the last block.
    ///
    /// # Errors
    /// Errors of `visit`.
    pub fn finish<E>(mut self, visit: &mut impl FnMut(&Row, &Outcome<S>) -> Result<(), E>) -> Result<(), E> {
        self.end_block(visit)
    }

    /// The covariance at the time of the row: the filter's own predictions take turns.
    fn row_covariance(&self, time_us: u64) -> RowCovariance {
        let elapsed =
            |at_us: &u64| time_us.saturating_sub(*at_us).min(LONGEST_PREDICTION_US) as f64 / 1e6 / TIME_UNIT_S;
        RowCovariance::new(self.covariance.p(), &self.predicted_at_us.iter().map(elapsed).collect::<Vec<_>>())
    }

    fn end_block<E>(&mut self, visit: &mut impl FnMut(&Row, &Outcome<S>) -> Result<(), E>) -> Result<(), E> {
        // The rows are those of the forward pass, and so are their blocks.
        let Some(mut adjoint) = self.adjoints.next() else { return Ok(()) };
        let (rows, steps) = (std::mem::take(&mut self.rows), std::mem::take(&mut self.steps));
        let mut undone = steps.len();
        let mut corrections = Vec::with_capacity(rows.len());
        for row in rows.iter().rev() {
            corrections.push(row.output.as_ref().map(|(place, covariance)| {
                while undone > *place {
                    undone -= 1;
                    adjoint.step_back(&steps[undone]);
                }
                covariance.smooth(&adjoint)
            }));
        }
        for (row, correction) in rows.into_iter().zip(corrections.into_iter().rev()) {
            let BufferedRow { row, mut outcome, absence, output, end } = row;
            outcome.smoothed = Some(match correction {
                Some(correction) => self.smooth(&row, &outcome, &correction, &absence),
                None => self.unsmoothed(&outcome),
            });
            let updates = output.map_or(&[][..], |(place, _)| &steps[place..end]);
            self.follow_updates(updates);
            visit(&row, &outcome)?;
        }
        Ok(())
    }

    fn smooth(
        &mut self,
        row: &Row,
        outcome: &Outcome<S>,
        correction: &Correction,
        absence: &[Q; MAX_SEGMENTS],
    ) -> Smoothed<S> {
        let sensors = outcome.conditions.iter().zip(&outcome.estimate.segments);
        let present: Vec<Present> = sensors
            .map(|(condition, segment)| Present { heading: !condition.imu_absent, bend: segment.bend.is_some() })
            .collect();
        let elapsed_s = row.sample.time_us.saturating_sub(self.last_us) as f64 / 1e6;
        self.last_us = row.sample.time_us;
        let corrections = self.headings.advance(correction, &present, elapsed_s);
        let fused = &outcome.shapes[Method::Fusion as usize];
        self.kinematics.smoothed(fused, corrections, &correction.covariance, absence)
    }

    /// A row of the tare, before the filter starts.
    fn unsmoothed(&mut self, outcome: &Outcome<S>) -> Smoothed<S> {
        self.headings = HeadingCorrections::new(self.predicted_at_us.len());
        let shape = outcome.shapes[Method::Fusion as usize].clone();
        Smoothed { shape, uncertainties: outcome.uncertainties.clone() }
    }

    fn follow_updates(&mut self, steps: &[Step]) {
        for step in steps {
            if let Step::Update { gain, nu, .. } = step {
                self.headings.follow_update((0..self.predicted_at_us.len()).map(|i| gain[bias(i)] * nu));
            }
        }
    }
}
