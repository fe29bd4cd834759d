//! The bias filter's model against the dense Kalman filter of the textbooks, in floats and in fixed point.

use estimator_core::{BiasFilterConfig, BiasState, FusedOps, Q, Scalar, TIME_UNIT_S, Turns};
use nalgebra::{SMatrix, SVector};

/// IMUs and segments, and their states.
const N: usize = 3;
const STATES: usize = 3 * N;
/// Samples a second.
const HZ: f64 = 100.0;

type Covariance = SMatrix<f64, STATES, STATES>;
type State = SVector<f64, STATES>;

/// Noise that keeps all variances above the floor for rounding.
fn config() -> BiasFilterConfig {
    BiasFilterConfig { rate_noise: Q::from_f64(1e-3), ..BiasFilterConfig::BNO055 }
}

/// Variance of the offsets' prior.
const OFFSET: f64 = 0.02;
const STRAIGHTNESS: f64 = 0.004;

/// x⁻ = A x, P⁻ = A P Aᵀ + Q; K = P⁻Hᵀ/(H P⁻Hᵀ + R), x = x⁻ + K ν, P = (I − K H) P⁻, all states at once.
struct Textbook {
    x: State,
    p: Covariance,
}

impl Textbook {
    fn new() -> Self {
        let config = config();
        let mut p = Covariance::zeros();
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            p[(3 * i, 3 * j)] = (1 + i.min(j)) as f64 * STRAIGHTNESS;
        }
        for i in 0..N {
            p[(3 * i, 3 * i)] += config.initial_bias.to_f64();
            p[(3 * i + 1, 3 * i + 1)] = config.initial_rate.to_f64();
            p[(3 * i + 2, 3 * i + 2)] = OFFSET;
        }
        Self { x: State::zeros(), p }
    }

    fn predict(&mut self, i: usize, dt: f64) {
        let config = config();
        let decay = 1.0 - config.offset_rate.to_f64() * dt;
        let mut a = Covariance::identity();
        a[(3 * i, 3 * i + 1)] = dt;
        a[(3 * i + 2, 3 * i + 2)] = decay;
        let mut q = Covariance::zeros();
        q[(3 * i, 3 * i)] = config.bias_noise.to_f64() * dt;
        q[(3 * i + 1, 3 * i + 1)] = config.rate_noise.to_f64() * dt;
        q[(3 * i + 2, 3 * i + 2)] = OFFSET * (1.0 - decay * decay);
        self.add(&(a * self.x - self.x));
        self.p = a * self.p * a.transpose() + q;
    }

    /// Changes the states. A bias is held in units of 2⁻³² turns, 1.5e-9 rad.
    fn add(&mut self, change: &State) {
        self.x += State::from_fn(|k, _| if k % 3 == 0 { Turns::from_rad(change[k]).rad() } else { change[k] });
    }

    /// Of z = H x + noise, with H = (β_i: 1, β_{i−1}: −1, o_i: −1).
    fn update(&mut self, i: usize, z: f64, r: f64) {
        let mut h = SVector::<f64, STATES>::zeros();
        h[3 * i] = 1.0;
        h[3 * i + 2] = -1.0;
        if i > 0 {
            h[3 * (i - 1)] = -1.0;
        }
        self.update_by(&h, z, r);
    }

    fn update_by(&mut self, h: &SVector<f64, STATES>, z: f64, r: f64) {
        let s = (h.transpose() * self.p * h).x + r;
        let k = self.p * h / s;
        self.add(&(k * (z - h.dot(&self.x))));
        self.p = (Covariance::identity() - k * h.transpose()) * self.p;
    }
}

/// The crate's filter, driven as the textbook's.
struct Driven<S> {
    state: BiasState<S, N>,
}

impl<S: FusedOps> Driven<S> {
    fn new() -> Self {
        let mut state = BiasState::new(S::zero());
        state.initialise(&config(), S::from_f64(STRAIGHTNESS), &[S::from_f64(OFFSET); N], 0);
        Self { state }
    }

    fn update(&mut self, i: usize, z: f64, r: f64) {
        let hx = self.state.angle_bias(i) - self.state.angle_offset(i);
        let innovation = self.state.innovation(i);
        self.state.update(innovation, S::from_f64(z) - hx, S::from_f64(r));
    }

    fn x(&self) -> State {
        let of = |i: usize| [self.state.bias[i].rad(), self.state.rate[i].to_f64(), self.state.offset[i].to_f64()];
        State::from_fn(|k, _| of(k / 3)[k % 3])
    }

    fn p(&self) -> Covariance {
        Covariance::from_fn(|j, k| self.state.covariance(j / 3, k / 3)[j % 3][k % 3].to_f64())
    }
}

/// A measurement of segment `i` at sample `k`: drifting IMUs and bend sensors that are off, rad.
fn measurement(i: usize, k: u64) -> f64 {
    let drift = [8e-4, -5e-4, 3e-4];
    let bias = |i: usize| drift[i] * k as f64 / HZ;
    let scatter = ((k * 7919 + i as u64 * 104_729) % 1000) as f64 / 1000.0 - 0.5;
    let below = i.checked_sub(1).map_or(0.0, bias);
    bias(i) - below - 0.03 * (i as f64 - 1.0) + 0.02 * scatter
}

/// Runs both for so many samples, one segment in its turn; `check` compares them after each update.
fn run<S: FusedOps>(samples: u64, mut check: impl FnMut(u64, &Driven<S>, &Textbook)) {
    let (mut driven, mut book) = (Driven::<S>::new(), Textbook::new());
    let mut predicted = [0; N];
    for k in 1..=samples {
        let i = (k % N as u64) as usize;
        driven.state.predict(i, &config(), S::from_f64(OFFSET), k * 10_000);
        book.predict(i, (k - predicted[i]) as f64 / HZ / TIME_UNIT_S);
        predicted[i] = k;
        // A segment whose sensors move now and then.
        if k % 40 < 20 {
            let (z, r) = (measurement(i, k), 0.5);
            driven.update(i, z, r);
            book.update(i, z, r);
        }
        check(k, &driven, &book);
    }
}

#[test]
fn in_floats_it_is_the_dense_filter_of_the_textbooks() {
    run::<f64>(20_000, |k, driven, book| {
        let x = (driven.x() - book.x).abs().max();
        assert!(x < 1e-9, "states differ by {x} after {k} samples");
        let p = (driven.p() - book.p).abs().max();
        assert!(p < 1e-9, "covariances differ by {p} after {k} samples");
    });
}

#[test]
fn in_fixed_point_it_is_near_the_dense_filter() {
    run::<Q>(20_000, |k, driven, book| {
        // The bias's process noise of a turn is four steps of 2⁻²⁶, and is rounded to half of one.
        let x = (driven.x() - book.x).abs().max();
        assert!(x < 5e-5, "states differ by {x} after {k} samples");
        let ratios = driven.p().diagonal().component_div(&book.p.diagonal());
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.03), "variances by {ratios} after {k} samples");
    });
}

#[test]
fn an_update_at_rest_is_that_of_the_textbooks() {
    let (mut driven, mut book) = (Driven::<f64>::new(), Textbook::new());
    for i in 0..N {
        driven.state.predict(i, &config(), OFFSET, 60_000_000);
        book.predict(i, 60.0 / TIME_UNIT_S);
    }
    let (rate, r) = (0.05, 0.01);
    let innovation = driven.state.innovation_at_rest(1);
    let nu = rate - driven.state.rate_of(1);
    driven.state.update(innovation, nu, r);
    let mut h = State::zeros();
    h[4] = 1.0;
    book.update_by(&h, rate, r);
    assert!((driven.x() - book.x).abs().max() < 2e-9 && (driven.p() - book.p).abs().max() < 1e-12);
}

/// The smallest eigenvalue of P over its largest.
fn least_eigenvalue(p: &Covariance) -> f64 {
    let eigenvalues = p.symmetric_eigenvalues();
    eigenvalues.min() / eigenvalues.max()
}

#[test]
fn over_hours_in_fixed_point_the_covariance_stays_symmetric_and_positive() {
    run::<Q>(3 * 360_000, |k, driven, _| {
        if k % 10_000 == 0 {
            let p = driven.p();
            assert_eq!(p, p.transpose());
            assert!(least_eigenvalue(&p) > -1e-5, "{} after {k} samples", least_eigenvalue(&p));
        }
    });
}

/// Ten minutes without bend sensors, and then rest: the rate explains most of the bias.
#[test]
fn rest_after_a_long_outage_leaves_the_covariance_positive() {
    let mut driven = Driven::<Q>::new();
    for minute in 1..=2 {
        for i in 0..N {
            driven.state.predict(i, &config(), Q::from_f64(OFFSET), minute * 300_000_000);
        }
    }
    for _ in 0..10 {
        for j in 0..N {
            let innovation = driven.state.innovation_at_rest(j);
            driven.state.update(innovation, Q::from_f64(0.001), Q::from_f64(0.02));
            assert!(least_eigenvalue(&driven.p()) > -1e-5, "{}", least_eigenvalue(&driven.p()));
        }
    }
}

/// All states are as unknown as they get: the sum of their variances is beyond fixed point.
#[test]
fn an_update_of_unknown_states_leaves_the_covariance_positive() {
    let config = BiasFilterConfig { initial_bias: Q::from_f64(16.0), ..config() };
    let mut state = BiasState::<Q, N>::new(Scalar::from_f64(0.0));
    state.initialise(&config, Q::from_f64(0.0), &[Q::from_f64(16.0); N], 0);
    let innovation = state.innovation(1);
    state.update(innovation, Q::from_f64(0.1), Q::from_f64(1.0));
    let driven = Driven { state };
    assert!(least_eigenvalue(&driven.p()) > -1e-6, "{}", least_eigenvalue(&driven.p()));
    let expected = 16.0 - 16.0 * 16.0 / 49.0;
    assert!((driven.p()[(3, 3)] - expected).abs() < 1e-5, "{} instead of {expected}", driven.p()[(3, 3)]);
}

#[test]
fn a_time_before_the_last_prediction_changes_nothing() {
    let mut driven = Driven::<Q>::new();
    driven.state.predict(0, &config(), Q::from_f64(OFFSET), 2_000_000);
    let before = (driven.x(), driven.p());
    driven.state.predict(0, &config(), Q::from_f64(OFFSET), 1_000_000);
    assert_eq!((driven.x(), driven.p()), before);
}

#[test]
fn a_segment_beyond_the_arm_changes_nothing() {
    let mut driven = Driven::<Q>::new();
    let before = (driven.x(), driven.p());
    driven.state.predict(N, &config(), Q::from_f64(OFFSET), 2_000_000);
    driven.state.inflate_variance(N, 0, Q::from_f64(1.0));
    assert_eq!((driven.x(), driven.p()), before);
}
