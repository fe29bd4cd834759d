//! Gradient descent, p ← p − α ∂RMSE/∂p. L-BFGS computes α from earlier gradients, one for each direction, and a line search
//! shortens the step until the RMSE falls.

use calibration_tables::StopReason;
use lbfgs::Lbfgs;

use super::error::TuningError;
use super::objective::Evaluation;

/// Number of gradients in the memory of L-BFGS.
const MEMORY: usize = 10;
/// Largest number of iterations.
pub(super) const MAX_ITERATIONS: u64 = 300;
/// Share by which the RMSE falls in [`PATIENCE`] iterations at convergence.
const CONVERGED: f64 = 1e-4;
const PATIENCE: usize = 5;
/// Largest change of a coordinate in one iteration.
const MAX_STEP: f64 = 1.0;
/// Share c₁ of the decrease by the slope that a step must reach (Armijo's condition).
const ARMIJO_C1: f64 = 1e-4;
/// Number of times that a step is halved before the search ends.
const HALVINGS: u32 = 12;

/// An iterate of the descent.
#[derive(Debug, Clone)]
pub(super) struct Iterate {
    /// 0 at the start.
    pub number: u64,
    pub place: Vec<f64>,
    pub found: Evaluation,
}

/// Descends from `start` and returns the reason of its end; `visit` receives every iterate and returns false to end it.
pub(super) fn descend(
    at: impl Fn(&[f64]) -> Evaluation,
    start: Vec<f64>,
    mut visit: impl FnMut(&Iterate) -> bool,
) -> Result<StopReason, TuningError> {
    let mut memory = Lbfgs::new(start.len(), MEMORY);
    let found = at(&start);
    let mut here = Iterate { number: 0, place: start, found };
    let mut losses = Vec::new();
    loop {
        let loss = here.found.loss;
        if !loss.is_finite() || !here.found.gradient.iter().all(|derivative| derivative.is_finite()) {
            return Err(TuningError::NotFinite);
        }
        if !visit(&here) {
            return Ok(StopReason::Interrupted);
        }
        if losses.len() >= PATIENCE && losses[losses.len() - PATIENCE] - loss < CONVERGED {
            return Ok(StopReason::Converged);
        }
        if here.number == MAX_ITERATIONS {
            return Err(TuningError::NotConverged { iterations: MAX_ITERATIONS });
        }
        losses.push(loss);
        memory.update_hessian(&here.found.gradient, &here.place);
        let Some(next) = step(&at, &here, &mut memory) else { return Ok(StopReason::Converged) };
        here = next;
    }
}

/// The next iterate; `None` where no step lowers the loss.
fn step(at: impl Fn(&[f64]) -> Evaluation, here: &Iterate, memory: &mut Lbfgs) -> Option<Iterate> {
    let gradient = &here.found.gradient;
    let mut direction = gradient.clone();
    memory.apply_hessian(&mut direction);
    let slope: f64 = gradient.iter().zip(&direction).map(|(derivative, d)| derivative * d).sum();
    let longest = direction.iter().fold(0.0, |longest: f64, d| longest.max(d.abs()));
    let mut length = f64::min(1.0, MAX_STEP / longest);
    for _ in 0..HALVINGS {
        let place: Vec<f64> = here.place.iter().zip(&direction).map(|(x, d)| x - length * d).collect();
        let found = at(&place);
        if found.loss <= here.found.loss - ARMIJO_C1 * length * slope {
            return Some(Iterate { number: here.number + 1, place, found });
        }
        length /= 2.0;
    }
    None
}
