//! First pass: the gains of all updates, and their effect on the adjoint, block by block.

use calibration_tables::{MAX_SEGMENTS, MAX_WINDOW};
use estimator_core::{ArmConfig, Estimator, FusedOps};
use proprio_session::Row;

use super::adjoint::{Adjoint, Block};
use super::covariance::CovarianceFilter;
use super::step::{BiasLog, STATES, Step};

/// Rows of a block. A pass keeps one block of rows; the first pass keeps two small matrices of each block.
pub const BLOCK_ROWS: usize = 2048;

/// The estimator with a log of the bias filter's operations.
pub type TracedEstimator<'t, S> = Estimator<'t, S, MAX_SEGMENTS, { MAX_WINDOW as usize }, BiasLog>;

/// An estimator for any table.
///
/// # Panics
/// Never: the checks of the table's file are at least as strict as the estimator's.
pub fn traced<'t, S: FusedOps>(config: &'t ArmConfig<'t, S>) -> Box<TracedEstimator<'t, S>> {
    Box::new(Estimator::with_trace(config, BiasLog::default()).expect("the file was checked"))
}

/// The pass over all rows before the [smoothing pass](super::SmoothingPass) over the same.
pub struct ForwardPass<'t, S> {
    estimator: Box<TracedEstimator<'t, S>>,
    covariance: CovarianceFilter,
    steps: Vec<Step>,
    rows: usize,
    blocks: Vec<Block>,
    states: usize,
}

impl<'t, S: FusedOps> ForwardPass<'t, S> {
    /// Before the first row.
    #[must_use]
    pub fn new(config: &'t ArmConfig<'t, S>) -> Self {
        let segments = config.segments.len();
        Self {
            estimator: traced(config),
            covariance: CovarianceFilter::new(segments),
            steps: Vec::new(),
            rows: 0,
            blocks: Vec::new(),
            states: STATES * segments,
        }
    }

    /// Takes a row.
    ///
    /// # Panics
    /// Never, as the table was checked.
    pub fn add(&mut self, row: &Row) {
        if row.starts {
            self.estimator.start().expect("the file was checked");
        }
        self.estimator.update(&row.sample);
        let operations = self.estimator.trace_mut().0.drain(..);
        self.steps.extend(operations.filter_map(|operation| self.covariance.apply(&operation)));
        self.rows += 1;
        if self.rows == BLOCK_ROWS {
            self.end_block();
        }
    }

    fn end_block(&mut self) {
        self.blocks.push(Block::new(self.states, &self.steps));
        self.steps.clear();
        self.rows = 0;
    }

    /// Runs backwards over all blocks; returns the adjoint after each of them, from the first to the last.
    #[must_use]
    pub fn finish(mut self) -> Vec<Adjoint> {
        self.end_block();
        let mut adjoint = Adjoint::zero(self.states);
        let mut after = Vec::with_capacity(self.blocks.len());
        while let Some(block) = self.blocks.pop() {
            let before = block.step_back(&adjoint);
            after.push(std::mem::replace(&mut adjoint, before));
        }
        after.reverse();
        after
    }
}
