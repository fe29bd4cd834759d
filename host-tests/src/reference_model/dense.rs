//! The Kalman filter as textbooks print it, over matrices of any size.

/// A matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    columns: usize,
    cells: Vec<Vec<f64>>,
}

impl Matrix {
    pub(super) fn new(rows: usize, columns: usize, cell: impl Fn(usize, usize) -> f64) -> Self {
        Self { columns, cells: (0..rows).map(|i| (0..columns).map(|j| cell(i, j)).collect()).collect() }
    }

    fn identity(size: usize) -> Self {
        Self::new(size, size, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    pub(super) fn rows(&self) -> usize {
        self.cells.len()
    }

    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        self.cells[i][j]
    }

    fn transposed(&self) -> Self {
        Self::new(self.columns, self.rows(), |i, j| self.at(j, i))
    }

    fn plus(&self, other: &Self) -> Self {
        Self::new(self.rows(), self.columns, |i, j| self.at(i, j) + other.at(i, j))
    }

    fn minus(&self, other: &Self) -> Self {
        Self::new(self.rows(), self.columns, |i, j| self.at(i, j) - other.at(i, j))
    }

    fn times(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.rows());
        Self::new(self.rows(), other.columns, |i, j| (0..self.columns).map(|k| self.at(i, k) * other.at(k, j)).sum())
    }

    /// Gauss–Jordan with pivoting.
    fn inverse(&self) -> Self {
        let n = self.rows();
        let mut left = self.cells.clone();
        let mut right = Self::identity(n).cells;
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| left[a][k].abs().total_cmp(&left[b][k].abs())).unwrap_or(k);
            left.swap(k, pivot);
            right.swap(k, pivot);
            let scale = left[k][k];
            assert!(scale != 0.0, "a singular matrix");
            for row in [&mut left[k], &mut right[k]] {
                for cell in row.iter_mut() {
                    *cell /= scale;
                }
            }
            for i in (0..n).filter(|&i| i != k) {
                let factor = left[i][k];
                for j in 0..n {
                    left[i][j] -= factor * left[k][j];
                    right[i][j] -= factor * right[k][j];
                }
            }
        }
        Self { columns: n, cells: right }
    }
}

/// State and covariance.
pub(super) struct Filter {
    pub(super) x: Matrix,
    p: Matrix,
}

impl Filter {
    /// x and P from the first measurement alone: weighted least squares, P = (Hᵀ R⁻¹ H)⁻¹, x = P Hᵀ R⁻¹ z.
    pub(super) fn start(z: &Matrix, h: &Matrix, r: &Matrix) -> Self {
        let weighted = h.transposed().times(&r.inverse());
        let p = weighted.times(h).inverse();
        Self { x: p.times(&weighted).times(z), p }
    }

    /// x⁻ = A x + B u, P⁻ = A P Aᵀ + Q, with A = I and no u; P grows to `limit` at most.
    pub(super) fn predict(&mut self, q: f64, limit: f64) {
        let n = self.x.rows();
        let a = Matrix::identity(n);
        let grown =
            a.times(&self.p).times(&a.transposed()).plus(&Matrix::new(n, n, |i, j| if i == j { q } else { 0.0 }));
        self.x = a.times(&self.x);
        self.p = Matrix::new(n, n, |i, j| grown.at(i, j).min(limit));
    }

    /// K = P⁻Hᵀ(H P⁻ Hᵀ + R)⁻¹, x = x⁻ + K(z − H x⁻), P = (I − K H) P⁻. Without measurements all stays.
    pub(super) fn update(&mut self, z: &Matrix, h: &Matrix, r: &Matrix) {
        let gain = self.p.times(&h.transposed()).times(&h.times(&self.p).times(&h.transposed()).plus(r).inverse());
        self.x = self.x.plus(&gain.times(&z.minus(&h.times(&self.x))));
        self.p = Matrix::identity(self.x.rows()).minus(&gain.times(h)).times(&self.p);
    }
}
