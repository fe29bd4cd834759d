//! Kalman filter of one segment's bend angle (KF_orient) or end point (KF_coord) (paper, eq. 8 to 12).
//!
//! A = I and B u = 0 (sessions need not contain pressures), so each coordinate is a scalar filter, and the coordinates
//! of one segment share their parameters and with them one covariance. As the noise of the two measurements is
//! uncorrelated, the matrix inverse of K = P⁻Hᵀ(H P⁻ Hᵀ + R)⁻¹ reduces to one division.

use nalgebra::SVector;

use crate::config::KalmanParams;
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::Constant;

/// Largest covariance P, as a ratio to the larger R. At this P the gain is nearly one, so that a larger P has no
/// effect; with H up to [`H_LIMIT`] the sum H² P + R stays below 32, the limit of [`Q`](crate::Q).
pub const COVARIANCE_LIMIT: f64 = 16.0;

const LIMIT: Constant = Constant::new(COVARIANCE_LIMIT);

/// The largest H.
pub const H_LIMIT: f64 = 1.25;

/// Constant terms of the update for one set of measurements.
///
/// With uncorrelated noise, P = P⁻ / (1 + P⁻ (h_a²/r_a + h_b²/r_b)) and K_a = P h_a / r_a. Multiplied through by the
/// Rs, so that nothing is large, r = r_a r_b, h² = h_a² r_b + h_b² r_a and k_a = h_a r_b; then u = P⁻ / (r + P⁻ h²) is
/// the only division of P = u r and x = x⁻ + u (k_a z_a + k_b z_b − h² x⁻).
#[derive(Debug, Clone, Copy)]
struct MeasurementWeights<S> {
    r: S,
    h_squared: S,
    /// Weights of z_imu, z_bend and x⁻ in the correction: k_a, k_b and −h².
    of: [S; 3],
}

impl<S: FusedOps> MeasurementWeights<S> {
    fn both(params: &KalmanParams<S>) -> Self {
        const LARGEST: Constant = Constant::new(31.0);
        const SHARE: Constant = Constant::new(1.0 / COVARIANCE_LIMIT);
        let h_squared = params.h_imu * params.h_imu * params.r_bend + params.h_bend * params.h_bend * params.r_imu;
        let of = [params.h_imu * params.r_bend, params.h_bend * params.r_imu, -h_squared];
        let weights = Self { r: params.r_imu * params.r_bend, h_squared, of };
        // The common factor is arbitrary: halved, P⁻ h² + r is in range.
        let fits = h_squared < (S::constant(LARGEST) - weights.r) * S::constant(SHARE);
        if fits { weights } else { weights.halved() }
    }

    fn halved(self) -> Self {
        Self { r: self.r.half(), h_squared: self.h_squared.half(), of: self.of.map(S::half) }
    }
}

/// Constant terms of a filter for each set of measurements that a sample can have.
#[derive(Debug, Clone, Copy)]
pub struct KalmanGains<S> {
    q: S,
    /// Largest P to which q can be added: [`COVARIANCE_LIMIT`] − q.
    p_limit: S,
    both: MeasurementWeights<S>,
    imu: MeasurementWeights<S>,
    bend: MeasurementWeights<S>,
}

impl<S: FusedOps> KalmanGains<S> {
    /// Computes the terms from a table's parameters.
    #[must_use]
    pub fn new(params: &KalmanParams<S>) -> Self {
        let KalmanParams { q, r_imu, r_bend, h_imu, h_bend } = *params;
        let zero = S::zero();
        Self {
            q,
            p_limit: S::constant(LIMIT) - q,
            both: MeasurementWeights::both(params),
            imu: MeasurementWeights { r: r_imu, h_squared: h_imu * h_imu, of: [h_imu, zero, -(h_imu * h_imu)] },
            bend: MeasurementWeights { r: r_bend, h_squared: h_bend * h_bend, of: [zero, h_bend, -(h_bend * h_bend)] },
        }
    }

    /// P⁻ = P + Q (process noise).
    #[inline]
    fn predict_covariance(&self, p: S) -> S {
        if p < self.p_limit { p + self.q } else { S::constant(LIMIT) }
    }

    /// u and P after one sample's measurements. Not inlined, so that it has all registers.
    #[inline(never)]
    fn update_covariance(&self, p: S, weights: &MeasurementWeights<S>) -> (S, S) {
        let ratio = self.predict_covariance(p).gain_over_innovation_variance(weights.r, weights.h_squared);
        (ratio, ratio.mul_unchecked_range(weights.r))
    }

    /// u and P after the first measurements, for an infinite P⁻.
    #[cold]
    #[inline(never)]
    fn initialise(weights: &MeasurementWeights<S>) -> (S, S) {
        let ratio = S::one() / weights.h_squared;
        (ratio, ratio.mul_unchecked_range(weights.r))
    }
}

/// State x (`D` coordinates) and their common covariance P, from the first measurement on.
///
/// [`Q`](crate::Q) stays within 1e-6 rad or m of `f64` while Q is at least 1/1000 of the larger R a sample, a memory of
/// some thirty samples; a slower filter has too few digits in P (error 2·10⁻⁵ at 1/10 000).
///
/// ```
/// use estimator_core::{KalmanFilter, KalmanGains, KalmanParams};
/// use nalgebra::SVector;
///
/// let gains = KalmanGains::new(&KalmanParams { q: 1.0, r_imu: 1.0, r_bend: 1.0, h_imu: 1.0, h_bend: 1.0 });
/// let mut filter = KalmanFilter::<f64, 1>::new();
/// filter.step(&gains, Some(SVector::from([2.0])), None);
/// filter.step(&gains, Some(SVector::from([5.0])), None);
/// let (state, covariance) = filter.state().expect("it was measured");
/// assert!((state.x - 4.0).abs() < 1e-12 && (covariance - 2.0 / 3.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct KalmanFilter<S, const D: usize> {
    state: Option<(SVector<S, D>, S)>,
}

impl<S: FusedOps, const D: usize> KalmanFilter<S, D> {
    /// A filter before its first measurement.
    #[must_use]
    pub const fn new() -> Self {
        Self { state: None }
    }

    /// x and P (ratio to the larger R), or `None` before the first measurement.
    #[must_use]
    pub const fn state(&self) -> Option<(SVector<S, D>, S)> {
        self.state
    }

    /// Predicts, x⁻ = x, P⁻ = P + Q (eq. 8, 9), and updates by the available measurements z = H x + noise (eq. 10 to
    /// 12). The first measurements initialise the filter.
    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    pub fn step(&mut self, gains: &KalmanGains<S>, imu: Option<SVector<S, D>>, bend: Option<SVector<S, D>>) {
        let zeros = SVector::zeros();
        let (weights, imu, bend) = match (imu, bend) {
            (Some(imu), Some(bend)) => (&gains.both, imu, bend),
            (Some(imu), None) => (&gains.imu, imu, zeros),
            (None, Some(bend)) => (&gains.bend, zeros, bend),
            (None, None) => {
                self.state = self.state.map(|(x, p)| (x, gains.predict_covariance(p)));
                return;
            }
        };
        let (x, (ratio, p)) = match self.state {
            Some((x, p)) => (x, gains.update_covariance(p, weights)),
            None => (zeros, KalmanGains::initialise(weights)),
        };
        let ([imu], [bend], [x]) = (imu.data.0, bend.data.0, x.data.0);
        self.state = Some((SVector::from(S::kalman_update(x, ratio, &weights.of, [imu, bend])), p));
    }
}

impl<S: FusedOps, const D: usize> Default for KalmanFilter<S, D> {
    fn default() -> Self {
        Self::new()
    }
}
