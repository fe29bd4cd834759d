//! The parameters of one filter, and the unbounded coordinates of the descent.

use calibration_tables::{H_RANGE, NoiseToml};
use estimator_core::{COVARIANCE_LIMIT, KalmanParams, Scalar};

use super::Dual;

/// Number of a filter's parameters: R_imu : R_bend, Q : (R_imu + R_bend) per second, H_imu and H_bend. Only the ratios of
/// covariances have an effect.
pub(super) const PARAMETERS: usize = 4;

/// Coordinates of one filter's parameters: all numbers are valid.
pub(super) type FilterCoordinates = [f64; PARAMETERS];

/// R_imu : R_bend.
const R_RATIO: [f64; 2] = [1e-4, 1e4];
/// Smallest Q per sample, relative to the larger R, at which fixed point keeps its digits, in a session and on the board.
const LEAST_Q_A_SAMPLE: f64 = 1e-3;
/// Sample rate of the board, Hz.
const BOARD_RATE_HZ: f64 = 100.0;
/// Q per second above which a filter has no memory, even at the board's rate.
const LARGEST_Q_A_SECOND: f64 = COVARIANCE_LIMIT * BOARD_RATE_HZ;
/// R_bend of the tables, rad² or m², with which all others are in the range of the format.
const R_BEND: [f64; 2] = [1e-8, 0.05];
/// Smallest distance of the start from the ends of a range, as a share of it: the slope vanishes at the ends.
const MARGIN: f64 = 0.001;
/// Change of the logarithm of a covariance and of H by a step of 1. A percent of H moves an arm by about as much as a factor e
/// of a covariance; in coordinates of equal effect, descent takes a fifth of the iterations.
const PACES: [f64; PARAMETERS] = [1.0, 1.0, 0.01, 0.01];

/// The ranges of the parameters. A coordinate x stands for lo (hi/lo)^σ(x), with σ the logistic function.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ranges([[f64; 2]; PARAMETERS]);

impl Ranges {
    /// For sessions of which the fastest has `rate_hz`.
    pub fn new(rate_hz: f64) -> Self {
        let q = [LEAST_Q_A_SAMPLE * rate_hz.max(BOARD_RATE_HZ), LARGEST_Q_A_SECOND];
        let h = [*H_RANGE.start(), *H_RANGE.end()];
        Self([R_RATIO, q, h, h])
    }

    /// Coordinates of a table's parameters; those out of range are at its end.
    pub fn place(&self, keys: &NoiseToml) -> FilterCoordinates {
        let values = [keys.r_imu / keys.r_bend, keys.q / (keys.r_imu + keys.r_bend), keys.h_imu, keys.h_bend];
        each(|k| {
            let [lo, hi] = self.0[k];
            let share = (libm::log(values[k] / lo) / libm::log(hi / lo)).clamp(MARGIN, 1.0 - MARGIN);
            libm::log(share / (1.0 - share)) / self.steepness(k)
        })
    }

    /// The parameters at a place in the form of a table, with this R_bend.
    pub fn keys(&self, place: &FilterCoordinates, r_bend: f64) -> NoiseToml {
        let [(ratio, _), (q, _), (h_imu, _), (h_bend, _)] = each(|k| self.value(k, place[k]));
        let r_bend = r_bend.clamp(R_BEND[0], R_BEND[1]);
        let r_imu = ratio * r_bend;
        NoiseToml { q: q * (r_imu + r_bend), r_imu, r_bend, h_imu, h_bend }
    }

    /// The filter's parameters at a place and sample rate, as many times as there are coordinates: each time with the
    /// derivatives by one of them.
    pub fn noises(&self, place: &FilterCoordinates, rate_hz: f64) -> [KalmanParams<Dual>; PARAMETERS] {
        let one = Dual::from_f64(1.0);
        each(|direction| {
            let [ratio, q, h_imu, h_bend] = each(|k| {
                let (value, slope) = self.value(k, place[k]);
                Dual::new(value, if k == direction { slope } else { 0.0 })
            });
            // As in a compiled table: ratios to the larger R, and Q per sample.
            let larger = if ratio > one { ratio } else { one };
            let q = q * (ratio + one) / (larger * Dual::from_f64(rate_hz));
            let limit = Dual::from_f64(COVARIANCE_LIMIT);
            KalmanParams {
                q: if q < limit { q } else { limit },
                r_imu: ratio / larger,
                r_bend: one / larger,
                h_imu,
                h_bend,
            }
        })
    }

    /// A parameter and its derivative by its coordinate.
    fn value(&self, k: usize, coordinate: f64) -> (f64, f64) {
        let [lo, hi] = self.0[k];
        let share = 1.0 / (1.0 + libm::exp(-self.steepness(k) * coordinate));
        let log_range = libm::log(hi / lo);
        let value = lo * libm::exp(log_range * share);
        (value, value * log_range * self.steepness(k) * share * (1.0 - share))
    }

    /// Steepness of the logistic function with which a coordinate has its pace in the middle of the range.
    fn steepness(&self, k: usize) -> f64 {
        let [lo, hi] = self.0[k];
        4.0 * PACES[k] / libm::log(hi / lo)
    }
}

fn each<T>(of: impl FnMut(usize) -> T) -> [T; PARAMETERS] {
    std::array::from_fn(of)
}
