//! Variances in the format of the estimator.

use estimator_core::{Q, VARIANCE_SCALE};

/// The scaled variance of a standard deviation in degrees.
pub(crate) fn variance(deviation_deg: f64) -> Q {
    Q::from_f64(deviation_deg.to_radians().powi(2) * VARIANCE_SCALE)
}
