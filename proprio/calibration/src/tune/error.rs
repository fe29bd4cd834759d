//! Errors of the tuning.

/// An error that prevents the tuning of a table's filters on a session.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TuningError {
    /// The table has no bend sensor, and so no fusion.
    #[error("no segment has a bend sensor, expected at least one: without any there is no fusion to tune")]
    NoBendSensors,
    /// The truth does not move.
    #[error(
        "the arm never moves: no true heading changes by more than {range_deg:.1}°, expected at least {least_deg}°"
    )]
    Still {
        /// Largest range of a segment's heading.
        range_deg: f64,
        /// Range needed.
        least_deg: f64,
    },
    /// Too little truth to tune on, or to check the tuning.
    #[error("{part} has {found} samples with a fused and a true tip, expected at least {least}")]
    TooFewSamples {
        /// Part of the session.
        part: &'static str,
        /// Samples found.
        found: u64,
        /// Samples needed.
        least: u64,
    },
    /// The truth is inconsistent.
    #[error("the truth's points are {percent:.0} % of the arm's length away from where its headings put them")]
    TruthMisfit {
        /// Root mean square distance of the tip from the chain of the true bend angles, % of the arm's length.
        percent: f64,
    },
    /// The errors do not converge.
    #[error("the filters do not converge: their RMSE still falls after {iterations} iterations, expected 30 to 50")]
    NotConverged {
        /// Largest number of iterations.
        iterations: u64,
    },
    /// The errors are no numbers.
    #[error("the errors of the filters are not finite, expected some mm and degrees")]
    NotFinite,
}
