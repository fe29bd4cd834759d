//! Options of a calibration.

/// Choices of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CalibrationOptions {
    /// V–Orient maps.
    pub maps: MapMode,
    /// Compensation of hysteresis and creep.
    pub hysteresis: HysteresisMode,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self { maps: MapMode::Auto, hysteresis: HysteresisMode::Auto }
    }
}

/// V–Orient maps that a table gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapMode {
    /// For each sensor a curve where that lowers the held-back error.
    Auto,
    /// Monotone curves.
    Curve,
    /// The paper's quadratics.
    Quadratic,
}

/// Form of a sensor's map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapKind {
    /// θ = c2 V² + c1 V + c0.
    Quadratic,
    /// A monotone curve.
    Curve,
}

/// Compensation of hysteresis and creep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HysteresisMode {
    /// Compensation of sensors and segments whose held-back error it lowers.
    Auto,
    /// Compensation of all.
    Always,
    /// No compensation.
    Never,
}
