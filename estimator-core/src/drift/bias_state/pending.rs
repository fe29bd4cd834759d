//! State of an update of the covariance by block rows.

/// Covariances of one state with all others: bias, rate and offset of each IMU and segment.
pub type Row<S, const N: usize> = [[S; 3]; N];

/// State of an update of P by block rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct CovarianceUpdate<S, const N: usize> {
    /// K, and P⁻Hᵀ of the newest innovation.
    pub gain: Row<S, N>,
    pub cross: Row<S, N>,
    /// Number of block rows that have been updated.
    pub rows_done: usize,
}

impl<S: Copy, const N: usize> CovarianceUpdate<S, N> {
    /// No update is pending.
    pub const fn complete(zero: S) -> Self {
        Self { gain: [[zero; 3]; N], cross: [[zero; 3]; N], rows_done: N }
    }
}
