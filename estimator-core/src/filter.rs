//! One decoupled block of KF_orient or KF_coord (paper, eq. 8 to 12).
//!
//! A = I and B u = 0 (sessions need not carry pressures), so each coordinate is a scalar filter, and the coordinates of
//! one block share their parameters and with them one covariance. Measurements with uncorrelated noise may be taken one
//! after the other, which replaces the matrix inverse of K = P⁻Hᵀ(H P⁻ Hᵀ + R)⁻¹ by one division each.

use nalgebra::SVector;

use crate::scalar::{Constant, Scalar};

/// Parameters of one block. Only the ratios of covariances act on the gains, so all are given as ratios to the larger of
/// R_imu and R_bend, which keeps them within [`Q`](crate::Q)'s range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise<S> {
    /// Q: growth of the covariance from one sample to the next.
    pub q: S,
    /// R of the drift-corrected IMU's measurement.
    pub r_imu: S,
    /// R of the bend sensors' measurement.
    pub r_bend: S,
    /// H of the drift-corrected IMU's measurement.
    pub h_imu: S,
    /// H of the bend sensors' measurement.
    pub h_bend: S,
}

/// The covariance of a block grows no further than this, as a ratio to the larger R: beyond it a measurement is taken for
/// what it says anyway, and with H up to [`H_LIMIT`] the sum H² P + R stays below 32, where [`Q`](crate::Q) ends.
pub const COVARIANCE_LIMIT: f64 = 16.0;

/// The largest H.
pub const H_LIMIT: f64 = 1.25;

/// State x (`D` coordinates) and their common covariance P, once there was a measurement.
///
/// [`Q`](crate::Q) stays within 1e-6 rad or m of `f64` while Q is at least 1/1000 of the larger R a sample, a memory of
/// some thirty samples; a slower filter has too few digits in P (2·10⁻⁵ at 1/10 000).
///
/// ```
/// use estimator_core::Block;
/// use nalgebra::SVector;
///
/// let mut block = Block::<f64, 1>::new();
/// block.update(SVector::from([2.0]), 1.0, 1.0);
/// block.predict(1.0);
/// block.update(SVector::from([5.0]), 1.0, 1.0);
/// let (state, covariance) = block.state().expect("it was measured");
/// assert!((state.x - 4.0).abs() < 1e-12 && (covariance - 2.0 / 3.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Block<S, const D: usize> {
    state: Option<(SVector<S, D>, S)>,
}

impl<S: Scalar, const D: usize> Block<S, D> {
    /// A filter that has not started.
    #[must_use]
    pub const fn new() -> Self {
        Self { state: None }
    }

    /// x and P (ratio to the larger R), or `None` before the first measurement.
    #[must_use]
    pub const fn state(&self) -> Option<(SVector<S, D>, S)> {
        self.state
    }

    /// x⁻ = x, P⁻ = P + Q (eq. 8, 9).
    pub fn predict(&mut self, q: S) {
        const LIMIT: Constant = Constant::new(COVARIANCE_LIMIT);
        if let Some((_, p)) = &mut self.state {
            let room = S::constant(LIMIT) - *p;
            *p += if q < room { q } else { room };
        }
    }

    /// Takes a measurement z = H x + noise of covariance R (eq. 10 to 12). The first one starts the filter: x = z / H,
    /// P = R / H².
    pub fn update(&mut self, z: SVector<S, D>, h: S, r: S) {
        match &mut self.state {
            None => {
                let inverse = S::one() / h;
                self.state = Some((z * inverse, r * inverse * inverse));
            }
            Some((x, p)) => {
                let ratio = *p / (h * h * *p + r);
                *x += (z - *x * h) * (ratio * h);
                *p = ratio * r;
            }
        }
    }
}

impl<S: Scalar, const D: usize> Default for Block<S, D> {
    fn default() -> Self {
        Self::new()
    }
}
