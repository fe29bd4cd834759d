//! Types of an arm's parameters.

use crate::layout::{PerBendSensor, PerRegulator, PerSegment};

/// All parameters of an arm.
#[derive(Clone, Debug)]
pub(crate) struct ArmParameters {
    pub(crate) regulators: PerRegulator<RegulatorParameters>,
    pub(crate) actuators: PerSegment<ActuatorParameters>,
    pub(crate) curves: PerSegment<CurveParameters>,
    pub(crate) strips: PerBendSensor<Option<StripParameters>>,
    pub(crate) pairs: PerSegment<PairParameters>,
    pub(crate) imus: PerSegment<Option<ImuParameters>>,
}

/// Parameters of a pressure regulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegulatorParameters {
    pub(crate) lag_s: f64,
    pub(crate) gain: f64,
    pub(crate) offset_pa: f64,
}

/// Parameters of the pneumatic half of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActuatorParameters {
    /// Gain to the right and to the left.
    pub(crate) gains: [f64; 2],
    pub(crate) stiffening: f64,
    pub(crate) play_rad: f64,
    pub(crate) lag_s: f64,
    pub(crate) creep_s: f64,
    pub(crate) creep_share: f64,
}

/// Parameters of a segment's centreline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveParameters {
    pub(crate) length_m: f64,
    pub(crate) connector_m: f64,
    pub(crate) connector_first: bool,
    pub(crate) slope: f64,
    pub(crate) bulge: f64,
    pub(crate) rest_bend_rad: f64,
    pub(crate) stretch_at_full_pressure: f64,
}

/// Parameters of a bend sensor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StripParameters {
    /// Start of the active part on the curve, and its length, shares of the curve's length.
    pub(crate) start: f64,
    pub(crate) length: f64,
    pub(crate) balance: f64,
    pub(crate) play_rad: [f64; 3],
    pub(crate) memory_share: [f64; 3],
    pub(crate) relaxation_s: f64,
    pub(crate) relaxation_share: f64,
    /// Fast and slow creep.
    pub(crate) creep_s: [f64; 2],
    pub(crate) creep_share: [f64; 2],
    /// Spread over sessions of the bend that is stored in the creep at the start.
    pub(crate) stored_bend_rad: [f64; 2],
    pub(crate) pre_bend_rad: f64,
    pub(crate) cubic_per_rad2: f64,
    pub(crate) ripple_rad: f64,
    pub(crate) ripple_rate: f64,
    pub(crate) ripple_phase_rad: f64,
    pub(crate) flat_ohm: f64,
    pub(crate) gauge_per_rad: f64,
    pub(crate) ohm_share_per_k: f64,
    pub(crate) noise_counts: f64,
}

/// Parameters of the common errors of the two strips of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairParameters {
    /// RMS of the slow error that cancels in the mean of both.
    pub(crate) opposed_rms_rad: f64,
    /// RMS of the slow error that is the same bend in both.
    pub(crate) shared_rms_rad: f64,
    pub(crate) time_s: f64,
    /// Largest constant offset of a session, three sigma.
    pub(crate) offset_rad: f64,
    pub(crate) bend_rad_per_k: f64,
}

/// Parameters of an IMU.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImuParameters {
    pub(crate) sensitivity: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
    pub(crate) plane_tilt_rad: f64,
    pub(crate) plane_direction_rad: f64,
    pub(crate) bias_rad_per_s: f64,
    pub(crate) turn_on_rad_per_s: f64,
    pub(crate) instability_rad_per_s: f64,
    pub(crate) instability_s: f64,
    pub(crate) rate_walk_rad_per_s: f64,
    pub(crate) heading_walk_rad: f64,
    pub(crate) rate_rad_per_s_per_k: f64,
    pub(crate) heading_noise_rad: f64,
    /// Heading error by acceleration across the arm, rad for each m/s².
    pub(crate) error_per_acceleration: f64,
    /// Heading error by angular acceleration, rad for each rad/s².
    pub(crate) error_per_spin: f64,
}
