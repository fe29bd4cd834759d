//! The reference arm, by which the recorded sessions of the tests were made. The order of the draws must not change:
//! another order results in other sessions.

use super::parameters::{
    ActuatorParameters, ArmParameters, CurveParameters, ImuParameters, PairParameters, RegulatorParameters,
    StripParameters,
};
use crate::constants::{
    ACTUATOR_CREEP_S, ACTUATOR_CREEP_SHARE, ACTUATOR_LAG_S, ACTUATOR_PLAY_RAD, ADC_NOISE_COUNTS, BULGE_MEAN,
    BULGE_SIGMA, COMMON_MODE_RAD, COMMON_MODE_S, DRIFT_RAD_PER_S, DRIFT_WALK_RAD_PER_S,
    ERROR_PER_ACCELERATION_RAD_S2_PER_M, ERROR_PER_SPIN_S2, FLAT_OHM, FLAT_SIGMA, GAIN_SIGMA, GAUGE_PER_RAD,
    GYRO_SENSITIVITY_SIGMA, HEADING_NOISE_RAD, MEMORY_PLAY_RAD, MEMORY_SHARE, MEMORY_SIGMA, PRE_BEND_RAD,
    REGULATOR_LAG_S, RIPPLE_PERIOD_RAD, RIPPLE_RAD, SLOPE_MEAN, SLOPE_SIGMA, STIFFENING, STORED_BEND_SIGMA_RAD,
    STRETCH_AT_FULL_PRESSURE, STRIP_BALANCE, STRIP_CREEP_S, STRIP_CREEP_SHARE, STRIP_LENGTH, STRIP_RELAXATION_S,
    STRIP_RELAXATION_SHARE, STRIP_START, TILT_SIGMA_RAD,
};
use crate::layout::{Layout, SegmentLayout};
use crate::noise::{Noise, Source};
use core::f64::consts::TAU;

/// An arm with the tolerances of the reference arm.
pub(crate) fn arm(layout: &Layout) -> ArmParameters {
    let regulator = RegulatorParameters { lag_s: REGULATOR_LAG_S, gain: 1.0, offset_pa: 0.0 };
    let pair = PairParameters {
        opposed_rms_rad: COMMON_MODE_RAD,
        shared_rms_rad: 0.0,
        time_s: COMMON_MODE_S,
        offset_rad: 0.0,
        bend_rad_per_k: 0.0,
    };
    let of = |source, device| Noise::of_arm(0, source, device);
    let segments = || layout.segments().iter().enumerate();
    ArmParameters {
        regulators: (0..layout.regulators()).map(|_| regulator).collect(),
        actuators: segments().map(|(segment, _)| actuator(&mut of(Source::Actuator, segment))).collect(),
        curves: segments().map(|(segment, layout)| curve(layout, &mut of(Source::Curve, segment))).collect(),
        strips: layout
            .bend_sensors()
            .map(|(index, has)| has.then(|| strip(&mut of(Source::BendSensor, index))))
            .collect(),
        pairs: segments().map(|_| pair).collect(),
        imus: segments()
            .map(|(segment, layout)| layout.imu.then(|| imu(segment, &mut of(Source::Imu, segment))))
            .collect(),
    }
}

fn actuator(noise: &mut Noise) -> ActuatorParameters {
    ActuatorParameters {
        gains: [noise.tolerance((1.0, GAIN_SIGMA)); 2],
        stiffening: STIFFENING,
        play_rad: ACTUATOR_PLAY_RAD,
        lag_s: ACTUATOR_LAG_S,
        creep_s: ACTUATOR_CREEP_S,
        creep_share: ACTUATOR_CREEP_SHARE,
    }
}

fn curve(layout: &SegmentLayout, noise: &mut Noise) -> CurveParameters {
    CurveParameters {
        length_m: layout.curve_m,
        connector_m: layout.connector_m,
        connector_first: layout.connector_first,
        slope: noise.tolerance((SLOPE_MEAN, SLOPE_SIGMA)),
        bulge: noise.tolerance((BULGE_MEAN, BULGE_SIGMA)),
        rest_bend_rad: 0.0,
        stretch_at_full_pressure: STRETCH_AT_FULL_PRESSURE,
    }
}

fn strip(noise: &mut Noise) -> StripParameters {
    let memory_scale = noise.tolerance((1.0, MEMORY_SIGMA));
    StripParameters {
        start: noise.tolerance(STRIP_START),
        length: STRIP_LENGTH,
        balance: noise.tolerance(STRIP_BALANCE),
        play_rad: MEMORY_PLAY_RAD,
        memory_share: MEMORY_SHARE.map(|share| memory_scale * share),
        creep_s: [STRIP_CREEP_S; 2],
        creep_share: [noise.tolerance(STRIP_CREEP_SHARE), 0.0],
        stored_bend_rad: [STORED_BEND_SIGMA_RAD, 0.0],
        relaxation_s: STRIP_RELAXATION_S,
        relaxation_share: noise.tolerance(STRIP_RELAXATION_SHARE),
        pre_bend_rad: noise.tolerance(PRE_BEND_RAD),
        cubic_per_rad2: 0.0,
        ripple_rad: RIPPLE_RAD,
        ripple_rate: TAU / noise.between(RIPPLE_PERIOD_RAD),
        ripple_phase_rad: noise.between((0.0, TAU)),
        flat_ohm: FLAT_OHM * noise.tolerance((1.0, FLAT_SIGMA)),
        gauge_per_rad: noise.tolerance(GAUGE_PER_RAD),
        ohm_share_per_k: 0.0,
        noise_counts: ADC_NOISE_COUNTS,
    }
}

fn imu(segment: usize, noise: &mut Noise) -> ImuParameters {
    ImuParameters {
        sensitivity: noise.tolerance((1.0, GYRO_SENSITIVITY_SIGMA)),
        pitch_rad: noise.tolerance((0.0, TILT_SIGMA_RAD)),
        roll_rad: noise.tolerance((0.0, TILT_SIGMA_RAD)),
        plane_tilt_rad: 0.0,
        plane_direction_rad: 0.0,
        bias_rad_per_s: DRIFT_RAD_PER_S[segment],
        turn_on_rad_per_s: 0.0,
        instability_rad_per_s: 0.0,
        instability_s: 1.0,
        rate_walk_rad_per_s: DRIFT_WALK_RAD_PER_S,
        heading_walk_rad: 0.0,
        rate_rad_per_s_per_k: 0.0,
        heading_noise_rad: HEADING_NOISE_RAD,
        error_per_acceleration: ERROR_PER_ACCELERATION_RAD_S2_PER_M,
        error_per_spin: ERROR_PER_SPIN_S2,
    }
}
