//! The 95 % ellipse of an estimated point.

use serde::{Deserialize, Serialize};

/// 95 % quantile of the χ² distribution with two degrees of freedom.
pub const CHI2_2_95: f64 = 5.991;

/// The ellipse about an estimated point that contains the true one with a probability of 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ellipse {
    /// Its longer semi-axis, mm.
    pub major_mm: f64,
    /// Its shorter semi-axis, mm.
    pub minor_mm: f64,
}

impl Ellipse {
    /// The ellipse of a point with the covariance xx, xy, yy in m².
    ///
    /// ```
    /// use proprio_session::Ellipse;
    ///
    /// // 3 mm and 1 mm of standard deviation, along the diagonals.
    /// let Ellipse { major_mm, minor_mm } = Ellipse::of([5e-6, 4e-6, 5e-6]);
    /// assert!((major_mm - 3.0 * 2.4477).abs() < 1e-3 && (minor_mm - 2.4477).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn of([xx, xy, yy]: [f64; 3]) -> Self {
        let (mean, apart) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
        let [major_mm, minor_mm] =
            [mean + apart, mean - apart].map(|variance| (CHI2_2_95 * variance.max(0.0)).sqrt() * 1e3);
        Self { major_mm, minor_mm }
    }
    /// Angle of the longer axis of that ellipse from x to y, rad.
    ///
    /// ```
    /// let diagonal = proprio_session::Ellipse::turn_rad([5e-6, 4e-6, 5e-6]);
    /// assert!((diagonal.to_degrees() - 45.0).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn turn_rad([xx, xy, yy]: [f64; 3]) -> f64 {
        f64::atan2(2.0 * xy, xx - yy) / 2.0
    }
}
