//! The smoother against a dense Rauch–Tung–Striebel smoother, which shares nothing with it.

use estimator_core::{BiasMeasurement, BiasOperation, Q, VARIANCE_SCALE};
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::adjoint::{Adjoint, Block};
use super::correction::{Correction, RowCovariance};
use super::covariance::CovarianceFilter;
use super::headings::{HeadingCorrections, Present};
use super::step::{STATES, Step};

const SEGMENTS: usize = 3;
const N: usize = STATES * SEGMENTS;
/// Operations of a sequence and of a block: blocks end anywhere.
const OPERATIONS: usize = 400;
const BLOCK: usize = 37;

/// Random numbers that are the same on every run.
struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// 0 to 1.
    fn share(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    fn below(&mut self, count: usize) -> usize {
        self.0.next_u32() as usize % count
    }

    /// A number in the estimator's fixed point, up to `largest`.
    fn q(&mut self, largest: f64) -> Q {
        Q::from_f64(largest * self.share())
    }

    fn noise(&mut self) -> [Q; 3] {
        [self.q(0.1), self.q(0.02), self.q(0.05)]
    }

    fn operation(&mut self) -> BiasOperation<Q> {
        let segment = self.below(SEGMENTS);
        let nu = Q::from_f64(0.2 * (self.share() - 0.5));
        let r = Q::from_f64(0.01 + self.share());
        match self.below(6) {
            0 | 1 => {
                let (dt, decay) = (self.q(0.3), Q::from_f64(0.9 + 0.1 * self.share()));
                BiasOperation::Predict { segment, dt, decay, noise: self.noise() }
            }
            2 => BiasOperation::Noise { segment, noise: self.noise() },
            3 => BiasOperation::Update { measurement: BiasMeasurement::BendAngle { segment }, nu, r },
            4 => BiasOperation::Update { measurement: BiasMeasurement::Rate { segment }, nu, r },
            _ => BiasOperation::Output,
        }
    }

    /// A prior and operations on it.
    fn operations(&mut self) -> Vec<BiasOperation<Q>> {
        let mut operations = vec![BiasOperation::Start { straightness: Q::from_f64(0.02) }];
        let prior = [0.05, 0.2, 0.04].map(Q::from_f64);
        operations.extend((0..SEGMENTS).map(|segment| BiasOperation::Noise { segment, noise: prior }));
        operations.extend((0..OPERATIONS).map(|_| self.operation()));
        operations
    }
}

/// A moment of the textbook's filter.
#[derive(Clone)]
struct Moment {
    x: DVector<f64>,
    p: DMatrix<f64>,
}

/// A transition matrix, and the moment that it comes from.
type Transition = (DMatrix<f64>, Moment);

/// The textbook: x and P before and after each transition F, and the recursion x_s = x + C (x_s' − F x),
/// P_s = P + C (P_s' − P') Cᵀ with C = P Fᵀ P'⁻¹. Gives the smoothed moment at each output.
fn rauch_tung_striebel(operations: &[BiasOperation<Q>]) -> Vec<Moment> {
    let mut now = Moment { x: DVector::zeros(N), p: DMatrix::zeros(N, N) };
    // Filtered moments, each with the transition and the predicted moment that follow it.
    let mut moments: Vec<(Moment, Option<Transition>, bool)> = Vec::new();
    for operation in operations {
        let mut transition = None;
        match *operation {
            BiasOperation::Start { straightness } => {
                now.x.fill(0.0);
                now.p = DMatrix::from_fn(N, N, |j, k| {
                    let common = (1 + (j / 3).min(k / 3)) as f64 * straightness.to_f64() / VARIANCE_SCALE;
                    if j % 3 == 0 && k % 3 == 0 { common } else { 0.0 }
                });
            }
            BiasOperation::Predict { segment, dt, decay, noise } => {
                let mut f = DMatrix::identity(N, N);
                f[(3 * segment, 3 * segment + 1)] = dt.to_f64();
                f[(3 * segment + 2, 3 * segment + 2)] = decay.to_f64();
                transition = Some((f, segment, noise));
            }
            BiasOperation::Noise { segment, noise } => transition = Some((DMatrix::identity(N, N), segment, noise)),
            BiasOperation::Update { measurement, nu, r } => update(&mut now, measurement, nu, r),
            BiasOperation::Output => {}
        }
        let is_output = *operation == BiasOperation::Output;
        match transition {
            Some((f, segment, noise)) => {
                let mut next = Moment { x: &f * &now.x, p: &f * &now.p * f.transpose() };
                for (k, noise) in noise.into_iter().enumerate() {
                    next.p[(3 * segment + k, 3 * segment + k)] += noise.to_f64() / VARIANCE_SCALE;
                }
                moments.push((now, Some((f, next.clone())), is_output));
                now = next;
            }
            None => moments.push((now.clone(), None, is_output)),
        }
    }
    let mut smoothed = now;
    let mut outputs = Vec::new();
    for (moment, transition, is_output) in moments.into_iter().rev() {
        // An update is no transition: the moment before it is that of the last transition.
        if let Some((f, predicted)) = transition {
            // Before the prior is complete P is singular, and there is no output.
            let Some(inverse) = predicted.p.clone().try_inverse() else { break };
            let c = &moment.p * f.transpose() * inverse;
            smoothed = Moment {
                x: &moment.x + &c * (&smoothed.x - &predicted.x),
                p: &moment.p + &c * (&smoothed.p - &predicted.p) * c.transpose(),
            };
        }
        if is_output {
            outputs.push(smoothed.clone());
        }
    }
    outputs.reverse();
    outputs
}

fn update(now: &mut Moment, measurement: BiasMeasurement, nu: Q, r: Q) {
    let mut h = DMatrix::<f64>::zeros(1, N);
    match measurement {
        BiasMeasurement::BendAngle { segment } => {
            (h[3 * segment], h[3 * segment + 2]) = (1.0, -1.0);
            if segment > 0 {
                h[3 * segment - 3] = -1.0;
            }
        }
        BiasMeasurement::Rate { segment } => h[3 * segment + 1] = 1.0,
    }
    let s = (&h * &now.p * h.transpose())[0] + r.to_f64() / VARIANCE_SCALE;
    let k = &now.p * h.transpose() / s;
    now.x += &k * nu.to_f64();
    now.p = (DMatrix::identity(N, N) - &k * h) * &now.p;
}

/// Filtered biases and offsets and their covariance at an output, and their correction.
struct Output {
    x: Vec<f64>,
    p: DMatrix<f64>,
    correction: Correction,
}

/// The smoother, block by block.
fn smooth(operations: &[BiasOperation<Q>]) -> Vec<Output> {
    let mut filter = CovarianceFilter::new(SEGMENTS);
    let (mut x, mut outputs) = (DVector::<f64>::zeros(N), Vec::new());
    let mut steps: Vec<Step> = Vec::new();
    for operation in operations {
        if *operation == BiasOperation::Output {
            let row = RowCovariance::new(filter.p(), &[0.0; SEGMENTS]);
            outputs.push((steps.len(), row, filter.p().clone(), x.clone()));
        }
        let step = filter.apply(operation);
        match &step {
            Some(Step::Start) => x.fill(0.0),
            Some(Step::Predict { segment, dt, decay }) => {
                x[3 * segment] += dt * x[3 * segment + 1];
                x[3 * segment + 2] *= decay;
            }
            Some(Step::Update { gain, nu, .. }) => x += DVector::from_column_slice(gain) * *nu,
            None => {}
        }
        steps.extend(step);
    }
    // The adjoint after each block, from the last to the first.
    let mut after = vec![Adjoint::zero(N)];
    for block in steps.chunks(BLOCK).rev() {
        after.push(Block::new(N, block).step_back(after.last().expect("it has one")));
    }
    after.reverse();
    let adjoint = |place: usize| {
        let block = place / BLOCK;
        let end = steps.len().min((block + 1) * BLOCK);
        let mut adjoint = after.get(block + 1).unwrap_or(&after[block]).clone();
        steps[place..end].iter().rev().for_each(|step| adjoint.step_back(step));
        adjoint
    };
    let smoothed = outputs.into_iter().map(|(place, row, p, x)| Output {
        x: (0..SEGMENTS).map(|i| x[3 * i]).chain((0..SEGMENTS).map(|i| x[3 * i + 2])).collect(),
        p: DMatrix::from_fn(SEGMENTS, SEGMENTS, |j, k| p[(3 * j, 3 * k)]),
        correction: row.smooth(&adjoint(place)),
    });
    smoothed.collect()
}

#[test]
fn states_and_covariances_are_those_of_a_dense_rauch_tung_striebel_smoother() {
    for seed in 0..20 {
        let operations = Random::new(seed).operations();
        let (found, expected) = (smooth(&operations), rauch_tung_striebel(&operations));
        assert_eq!(found.len(), expected.len());
        for (Output { x, correction, .. }, book) in found.iter().zip(&expected) {
            let change = correction.biases.iter().chain(&correction.offsets);
            for (k, (x, change)) in x.iter().zip(change).enumerate() {
                let book = book.x[if k < SEGMENTS { 3 * k } else { 3 * (k - SEGMENTS) + 2 }];
                assert!((x + change - book).abs() < 1e-9, "state {k} of seed {seed}: {} for {book}", x + change);
            }
            let book = DMatrix::from_fn(SEGMENTS, SEGMENTS, |j, k| book.p[(3 * j, 3 * k)]);
            let difference = (&correction.covariance - book).abs().max();
            assert!(difference < 1e-9, "covariances of seed {seed} differ by {difference}");
        }
    }
}

#[test]
fn the_smoothed_covariance_is_positive_and_never_larger_than_that_of_the_filter() {
    for seed in 100..120 {
        for Output { p, correction, .. } in smooth(&Random::new(seed).operations()) {
            let least = |matrix: DMatrix<f64>| matrix.symmetric_eigenvalues().min();
            assert!(least(correction.covariance.clone()) > 0.0);
            assert!(least(p - correction.covariance) > -1e-15);
        }
    }
}

#[test]
fn after_the_last_update_nothing_is_corrected() {
    let mut operations = Random::new(7).operations();
    operations.extend([BiasOperation::Noise { segment: 1, noise: [Q::from_f64(0.1); 3] }, BiasOperation::Output]);
    let outputs = smooth(&operations);
    let Output { p, correction, .. } = outputs.last().expect("there is one");
    assert_eq!(correction, &Correction { biases: vec![0.0; 3], offsets: vec![0.0; 3], covariance: p.clone() });
}

#[test]
fn a_start_of_the_estimator_leaves_the_piece_before_as_it_was() {
    let first = Random::new(8).operations();
    let both = [first.clone(), Random::new(9).operations()].concat();
    for (alone, followed) in smooth(&first).iter().zip(&smooth(&both)) {
        let changes = alone.correction.biases.iter().zip(&followed.correction.biases);
        changes.for_each(|(alone, followed)| assert!((alone - followed).abs() < 1e-12));
    }
}

/// Corrections of the biases alone.
fn of_biases(biases: [f64; 3]) -> Correction {
    Correction { biases: biases.to_vec(), offsets: vec![0.0; 3], covariance: DMatrix::zeros(3, 3) }
}

const READ: Present = Present { heading: true, bend: true };
const ABSENT: Present = Present { heading: false, bend: true };

#[test]
fn bend_angles_are_corrected_by_the_biases_of_both_headings() {
    let mut headings = HeadingCorrections::new(3);
    assert_eq!(headings.advance(&of_biases([0.1, 0.3, 0.2]), &[READ; 3], 0.1), [-0.1, -0.3 - -0.1, -0.2 - -0.3]);
}

#[test]
fn an_absent_heading_keeps_its_correction_and_is_drawn_to_that_of_the_bend_sensors() {
    let mut headings = HeadingCorrections::new(3);
    headings.advance(&of_biases([0.1, 0.3, 0.5]), &[READ; 3], 0.1);
    let mut correction = of_biases([0.1, 0.9, 0.5]);
    correction.offsets = vec![0.0, 0.02, 0.0];
    let present = [READ, ABSENT, READ];
    let at_once = headings.advance(&correction, &present, 0.0)[1];
    assert!((at_once + 0.2).abs() < 1e-12, "the bias that is not read plays no part: {at_once}");
    let mut later = 0.0;
    for _ in 0..3000 {
        later = headings.advance(&correction, &present, 0.1)[1];
    }
    assert!((later + 0.02).abs() < 1e-3, "{later}");
}

#[test]
fn an_update_of_the_filter_does_not_turn_an_absent_heading() {
    let mut headings = HeadingCorrections::new(3);
    let present = [READ, READ, ABSENT];
    headings.advance(&of_biases([0.1, 0.3, 0.5]), &[READ; 3], 0.1);
    let before: f64 = headings.advance(&of_biases([0.1, 0.3, 0.5]), &present, 0.0).iter().sum();
    // The filter turns all headings; the corrections of those that are read shrink by as much.
    headings.follow_update([0.1, 0.3, 0.05].into_iter());
    let after: f64 = headings.advance(&of_biases([0.0, 0.0, 0.0]), &present, 0.0).iter().sum();
    assert!((after - (before + 0.05)).abs() < 1e-12, "{before} and {after}");
}
