//! Errors of truth that cannot be used.

use proprio_analysis::check::Finding;

/// Truth that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TruthError {
    /// Places or headings in another unit.
    #[error("{0}")]
    Unit(Finding),
    /// The lengths of another arm.
    #[error("{0}")]
    Lengths(TruthLengths),
    /// Too many wrong poses.
    #[error(
        "{percent:.0} % of the truth's poses are wrong, expected at most {most:.0} %; the most frequent fault: {worst}"
    )]
    Wrong {
        /// Share of the wrong poses, %.
        percent: f64,
        /// Allowed share, %.
        most: f64,
        /// The finding of the most rows.
        worst: Finding,
    },
}

/// Lengths that the markers fit, in terms of the first segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthLengths {
    /// Lengths by the truth over those of the arm.
    pub scale: f64,
    /// Length of the first segment in the arm description, mm.
    pub given_mm: f64,
}

impl std::fmt::Display for TruthLengths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { scale, given_mm } = self;
        write!(f, "the markers fit lengths of {:.1} mm, the arm description has {given_mm} mm", scale * given_mm)
    }
}
