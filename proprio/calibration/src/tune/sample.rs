//! A sample of a training session.

use proprio_session::Truth;

/// One segment in one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    /// θ_c as the filters take it, rad.
    pub imu_c: Option<f64>,
    /// θ_bend, rad.
    pub bend: Option<f64>,
    pub truth: Option<Truth>,
}

impl Measured {
    pub const fn unknown(truth: Option<Truth>) -> Self {
        Self { imu_c: None, bend: None, truth }
    }
}

/// One sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrainingSample<'t> {
    pub is_validation: bool,
    /// The filters are started (again) before it.
    pub starts: bool,
    /// Its segments.
    pub measured: &'t [Measured],
}
