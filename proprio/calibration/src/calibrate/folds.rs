//! Contiguous tenths of the sweep: each is predicted from the other nine.

/// Number of parts.
pub(super) const FOLDS: usize = 10;

/// One reading of a bend sensor and the true bend angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observation {
    /// Row of the sweep.
    pub row: usize,
    /// V.
    pub volts: f64,
    /// rad.
    pub theta: f64,
    /// Part of the sweep.
    pub fold: usize,
}

/// Part of a sweep of so many rows that a row is in.
pub(super) fn fold(row: usize, rows: usize) -> usize {
    row * FOLDS / rows.max(1)
}
