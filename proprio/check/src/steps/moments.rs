//! Second moments of the steps of the IMUs and of the bend angles.

use calibration_tables::MAX_SEGMENTS;

pub(super) type Matrix = [[f64; MAX_SEGMENTS]; MAX_SEGMENTS];

const ZERO: Matrix = [[0.0; MAX_SEGMENTS]; MAX_SEGMENTS];

/// Sums of products, and their number.
#[derive(Debug, Clone)]
struct Sums {
    sum: Matrix,
    count: Matrix,
}

/// Moments of the steps: of IMUs by IMUs, of IMUs by bend angles, of bend angles.
#[derive(Debug, Clone)]
pub(super) struct Moments {
    imu_imu: Sums,
    imu_bend: Sums,
    bend_bend: Sums,
}

impl Sums {
    const ZERO: Self = Self { sum: ZERO, count: ZERO };

    fn add(&mut self, i: usize, j: usize, product: f64) {
        if !product.is_nan() {
            self.sum[i][j] += product;
            self.count[i][j] += 1.0;
        }
    }

    fn mean(&self) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| self.sum[i][j] / self.count[i][j].max(1.0)))
    }

    /// The means of a symmetric matrix of which the lower half was added.
    fn symmetric_mean(&self) -> Matrix {
        let half = self.mean();
        std::array::from_fn(|i| std::array::from_fn(|j| half[i.max(j)][i.min(j)]))
    }
}

impl Moments {
    pub const ZERO: Self = Self { imu_imu: Sums::ZERO, imu_bend: Sums::ZERO, bend_bend: Sums::ZERO };

    /// Adds a step of the headings and of the bend angles.
    pub fn add(&mut self, segments: usize, heading: &[f64; MAX_SEGMENTS], theta: &[f64; MAX_SEGMENTS]) {
        for i in 0..segments {
            for j in 0..segments {
                self.imu_bend.add(i, j, heading[i] * theta[j]);
                if j <= i {
                    self.imu_imu.add(i, j, heading[i] * heading[j]);
                    self.bend_bend.add(i, j, theta[i] * theta[j]);
                }
            }
        }
    }

    /// Number of steps of a segment: of its own IMU and the one before.
    pub fn count(&self, i: usize) -> f64 {
        let own = self.imu_bend.count[i][i];
        i.checked_sub(1).map_or(own, |before| own.min(self.imu_bend.count[before][i]))
    }

    /// Mean products of IMUs by IMUs.
    pub fn imu_imu(&self) -> Matrix {
        self.imu_imu.symmetric_mean()
    }

    /// Mean products of IMUs by bend angles.
    pub fn imu_bend(&self) -> Matrix {
        self.imu_bend.mean()
    }

    /// Mean products of bend angles.
    pub fn bend_bend(&self) -> Matrix {
        self.bend_bend.symmetric_mean()
    }
}
