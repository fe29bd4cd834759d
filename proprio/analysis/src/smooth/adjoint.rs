//! The adjoint state λ and its matrix Λ, backwards (modified Bryson–Frazier), step by step and in blocks of steps.

use nalgebra::{DMatrix, DVector};

use super::step::{Step, bias, offset, rate};

/// λ and Λ: the information of the later measurements about the states x. The smoothed estimate is x − P λ, its covariance
/// P − P Λ P.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjoint {
    /// λ.
    pub vector: DVector<f64>,
    /// Λ.
    pub matrix: DMatrix<f64>,
}

impl Adjoint {
    /// At the end of a session: no measurement follows.
    pub fn zero(states: usize) -> Self {
        Self { vector: DVector::zeros(states), matrix: DMatrix::zeros(states, states) }
    }

    /// Goes back over `step`.
    ///
    /// Prediction: λ⁻ = Aᵀλ, Λ⁻ = AᵀΛA. Update: λ⁻ = (I − K H)ᵀλ − Hᵀν/S, Λ⁻ = (I − K H)ᵀΛ(I − K H) + HᵀH/S.
    pub fn step_back(&mut self, step: &Step) {
        let Self { vector, matrix } = self;
        match step {
            Step::Start => {
                vector.fill(0.0);
                matrix.fill(0.0);
            }
            Step::Predict { segment: i, dt, decay } => {
                let (bias, rate, offset) = (bias(*i), rate(*i), offset(*i));
                vector[rate] += dt * vector[bias];
                vector[offset] *= decay;
                transpose_predict(matrix, *i, *dt, *decay);
                for k in 0..matrix.nrows() {
                    matrix[(k, rate)] += dt * matrix[(k, bias)];
                    matrix[(k, offset)] *= decay;
                }
            }
            Step::Update { row, gain, nu, s } => {
                let gain = DVector::from_column_slice(gain);
                let of_gain = &*matrix * &gain;
                let (along, square) = (gain.dot(vector) + nu / s, gain.dot(&of_gain) + 1.0 / s);
                for (at, h) in row {
                    vector[*at] -= h * along;
                    for k in 0..of_gain.len() {
                        matrix[(*at, k)] -= h * of_gain[k];
                        matrix[(k, *at)] -= h * of_gain[k];
                    }
                    for (other, other_h) in row {
                        matrix[(*at, *other)] += h * other_h * square;
                    }
                }
            }
        }
    }
}

/// M ← Aᵀ M.
fn transpose_predict(matrix: &mut DMatrix<f64>, i: usize, dt: f64, decay: f64) {
    for k in 0..matrix.ncols() {
        matrix[(rate(i), k)] += dt * matrix[(bias(i), k)];
        matrix[(offset(i), k)] *= decay;
    }
}

/// A block of consecutive steps, as one step back: λ before it is B λ + λ₀, Λ before it B Λ Bᵀ + Λ₀.
#[derive(Debug, Clone)]
pub struct Block {
    /// B.
    transition: DMatrix<f64>,
    /// λ₀ and Λ₀.
    own: Adjoint,
}

impl Block {
    /// Composes these steps.
    pub fn new(states: usize, steps: &[Step]) -> Self {
        let (mut transition, mut own) = (DMatrix::identity(states, states), Adjoint::zero(states));
        for step in steps.iter().rev() {
            own.step_back(step);
            match step {
                Step::Start => transition.fill(0.0),
                Step::Predict { segment, dt, decay } => transpose_predict(&mut transition, *segment, *dt, *decay),
                Step::Update { row, gain, .. } => {
                    let of_gain = transition.tr_mul(&DVector::from_column_slice(gain));
                    for (at, h) in row {
                        for k in 0..states {
                            transition[(*at, k)] -= h * of_gain[k];
                        }
                    }
                }
            }
        }
        Self { transition, own }
    }

    /// The adjoint before the block, from that after it.
    pub fn step_back(&self, after: &Adjoint) -> Adjoint {
        let Self { transition, own } = self;
        Adjoint {
            vector: transition * &after.vector + &own.vector,
            matrix: transition * &after.matrix * transition.transpose() + &own.matrix,
        }
    }
}
