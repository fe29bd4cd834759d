//! All arms but the reference arm: every flaw is drawn from the sizes in `flaws`.

use super::parameters::{
    ActuatorParameters, ArmParameters, CurveParameters, ImuParameters, PairParameters, RegulatorParameters,
    StripParameters,
};
use crate::constants::{
    ERROR_PER_ACCELERATION_RAD_S2_PER_M, ERROR_PER_SPIN_S2, FLAT_OHM, FLAT_SIGMA, FULL_SCALE_PA, MEMORY_PLAY_RAD,
    MEMORY_SHARE,
};
use crate::flaws::{
    ACCELERATION_SCALE_RANGE, ACTUATOR_ASYMMETRY_SIGMA, ACTUATOR_CREEP_RANGE_S, ACTUATOR_CREEP_SHARE_RANGE,
    ACTUATOR_GAIN_SIGMA, ACTUATOR_LAG_RANGE_S, ACTUATOR_PLAY_RANGE_RAD, ADC_NOISE_RANGE_COUNTS, BIAS_SIGMA_RAD_PER_S,
    BULGE_RANGE, BULGE_SIGMA, CONNECTOR_SIGMA, CREEP_RANGES_S, CREEP_SHARE_RANGES, CUBIC_RANGE_PER_RAD2,
    GAUGE_RANGE_PER_RAD, GAUGE_SIGMA, HEADING_NOISE_RANGE_RAD, HEADING_WALK_RAD, INSTABILITY_RANGE_RAD_PER_S,
    INSTABILITY_RANGE_S, LENGTH_SIGMA, MEMORY_SCALE_RANGE, MOUNT_TILT_SIGMA_RAD, OFFSET_RANGE_RAD,
    OFFSET_SHARE_OF_ARMS, PLANE_TILT_RANGE_RAD, PLAY_SCALE_RANGE, PRE_BEND_RANGE_RAD, PRE_BEND_SIGMA_RAD,
    RATE_SIGMA_RAD_PER_S_PER_K, RATE_WALK_RANGE_RAD_PER_S, REGULATOR_GAIN_SIGMA, REGULATOR_LAG_RANGE_S,
    REGULATOR_OFFSET_SIGMA, RELAXATION_RANGE_S, RELAXATION_SHARE_RANGE, REST_BEND_SIGMA_RAD, RIPPLE_PERIOD_RANGE_RAD,
    RIPPLE_RANGE_RAD, SENSITIVITY_RANGE, SLOPE_RANGE, SLOPE_SIGMA, SLOW_ERROR_LOG_RANGE, SLOW_ERROR_RANGE_RAD,
    SLOW_ERROR_SHARED_RANGE, STIFFENING_RANGE, STORED_BEND_SIGMAS_RAD, STRETCH_RANGE, STRIP_BALANCE_SIGMA,
    STRIP_LENGTH_RANGE, STRIP_PLACE_SIGMA, STRIP_RANGE_PER_K, STRIP_SIGMA, STRIP_SIGMA_PER_K,
    THERMAL_BEND_SIGMA_RAD_PER_K, TURN_ON_RANGE_RAD_PER_S,
};
use crate::layout::{Layout, SegmentLayout};
use crate::noise::{Noise, Source};
use core::f64::consts::{PI, TAU};

/// Device number of the stream of a batch, larger than that of any device.
const BATCH: usize = 1000;

/// The arm of a seed with this layout.
pub(crate) fn arm(arm_seed: u64, layout: &Layout) -> ArmParameters {
    let of = |source, device| Noise::of_arm(arm_seed, source, device);
    let curves = CurveBatch::new(of(Source::Curve, BATCH));
    let strips = StripBatch::new(of(Source::BendSensor, BATCH));
    let pairs = PairBatch::new(of(Source::CommonMode, BATCH));
    let imus = ImuBatch::new(of(Source::Imu, BATCH));
    let segments = || layout.segments().iter().enumerate();
    ArmParameters {
        regulators: (0..layout.regulators()).map(|index| regulator(of(Source::Regulator, index))).collect(),
        actuators: segments().map(|(segment, _)| actuator(of(Source::Actuator, segment))).collect(),
        curves: segments().map(|(segment, layout)| curves.device(layout, of(Source::Curve, segment))).collect(),
        strips: layout
            .bend_sensors()
            .map(|(index, has)| has.then(|| strips.device(of(Source::BendSensor, index))))
            .collect(),
        pairs: segments().map(|(segment, _)| pairs.device(of(Source::CommonMode, segment))).collect(),
        imus: segments().map(|(segment, layout)| layout.imu.then(|| imus.device(of(Source::Imu, segment)))).collect(),
    }
}

fn regulator(mut noise: Noise) -> RegulatorParameters {
    RegulatorParameters {
        lag_s: noise.between(REGULATOR_LAG_RANGE_S),
        gain: noise.tolerance((1.0, REGULATOR_GAIN_SIGMA)),
        offset_pa: FULL_SCALE_PA * noise.tolerance((0.0, REGULATOR_OFFSET_SIGMA)),
    }
}

fn actuator(mut noise: Noise) -> ActuatorParameters {
    let gain = noise.tolerance((1.0, ACTUATOR_GAIN_SIGMA));
    let asymmetry = noise.tolerance((0.0, ACTUATOR_ASYMMETRY_SIGMA));
    ActuatorParameters {
        gains: [gain * (1.0 + asymmetry), gain * (1.0 - asymmetry)],
        stiffening: noise.between(STIFFENING_RANGE),
        play_rad: noise.between(ACTUATOR_PLAY_RANGE_RAD),
        lag_s: noise.between(ACTUATOR_LAG_RANGE_S),
        creep_s: noise.between(ACTUATOR_CREEP_RANGE_S),
        creep_share: noise.between(ACTUATOR_CREEP_SHARE_RANGE),
    }
}

/// Common properties of an arm's curves.
struct CurveBatch {
    slope: f64,
    bulge: f64,
    stretch: f64,
}

impl CurveBatch {
    fn new(mut noise: Noise) -> Self {
        Self {
            slope: noise.between(SLOPE_RANGE),
            bulge: noise.between(BULGE_RANGE),
            stretch: noise.between(STRETCH_RANGE),
        }
    }

    fn device(&self, layout: &SegmentLayout, mut noise: Noise) -> CurveParameters {
        CurveParameters {
            length_m: layout.curve_m * noise.tolerance((1.0, LENGTH_SIGMA)),
            connector_m: layout.connector_m * noise.tolerance((1.0, CONNECTOR_SIGMA)),
            connector_first: layout.connector_first,
            slope: noise.tolerance((self.slope, SLOPE_SIGMA)),
            bulge: noise.tolerance((self.bulge, BULGE_SIGMA)),
            rest_bend_rad: noise.tolerance((0.0, REST_BEND_SIGMA_RAD)),
            stretch_at_full_pressure: self.stretch,
        }
    }
}

/// Common properties of an arm's strips.
struct StripBatch {
    length: f64,
    pre_bend_rad: f64,
    gauge_per_rad: f64,
    ripple_rad: f64,
    memory_scale: f64,
    play_scale: f64,
    ohm_share_per_k: f64,
    noise_counts: f64,
}

impl StripBatch {
    fn new(mut noise: Noise) -> Self {
        Self {
            length: noise.between(STRIP_LENGTH_RANGE),
            pre_bend_rad: noise.between(PRE_BEND_RANGE_RAD),
            gauge_per_rad: noise.between(GAUGE_RANGE_PER_RAD),
            ripple_rad: noise.between(RIPPLE_RANGE_RAD),
            memory_scale: noise.between(MEMORY_SCALE_RANGE),
            play_scale: noise.between(PLAY_SCALE_RANGE),
            ohm_share_per_k: noise.between(STRIP_RANGE_PER_K),
            noise_counts: noise.between(ADC_NOISE_RANGE_COUNTS),
        }
    }

    fn device(&self, mut noise: Noise) -> StripParameters {
        let memory_scale = self.memory_scale * noise.tolerance((1.0, STRIP_SIGMA));
        StripParameters {
            start: noise.tolerance(((1.0 - self.length) / 2.0, STRIP_PLACE_SIGMA)),
            length: self.length,
            balance: noise.tolerance((0.5, STRIP_BALANCE_SIGMA)),
            play_rad: MEMORY_PLAY_RAD.map(|radius| self.play_scale * radius),
            memory_share: MEMORY_SHARE.map(|share| memory_scale * share),
            relaxation_s: noise.between(RELAXATION_RANGE_S),
            relaxation_share: noise.between(RELAXATION_SHARE_RANGE),
            creep_s: CREEP_RANGES_S.map(|range| noise.between(range)),
            creep_share: CREEP_SHARE_RANGES.map(|range| noise.between(range)),
            stored_bend_rad: STORED_BEND_SIGMAS_RAD,
            pre_bend_rad: noise.tolerance((self.pre_bend_rad, PRE_BEND_SIGMA_RAD)),
            cubic_per_rad2: noise.between(CUBIC_RANGE_PER_RAD2),
            ripple_rad: self.ripple_rad * noise.tolerance((1.0, STRIP_SIGMA)),
            ripple_rate: TAU / noise.between(RIPPLE_PERIOD_RANGE_RAD),
            ripple_phase_rad: noise.between((0.0, TAU)),
            flat_ohm: FLAT_OHM * noise.tolerance((1.0, FLAT_SIGMA)),
            gauge_per_rad: self.gauge_per_rad * noise.tolerance((1.0, GAUGE_SIGMA)),
            ohm_share_per_k: noise.tolerance((self.ohm_share_per_k, STRIP_SIGMA_PER_K)),
            noise_counts: self.noise_counts,
        }
    }
}

/// Common properties of an arm's pairs of strips.
struct PairBatch {
    rms_rad: f64,
    shared: f64,
    time_s: f64,
    offset_rad: f64,
}

impl PairBatch {
    fn new(mut noise: Noise) -> Self {
        let has_offset = noise.uniform() < OFFSET_SHARE_OF_ARMS;
        let offset_rad = noise.between(OFFSET_RANGE_RAD);
        Self {
            rms_rad: noise.between(SLOW_ERROR_RANGE_RAD),
            shared: noise.between(SLOW_ERROR_SHARED_RANGE),
            time_s: libm::exp(noise.between(SLOW_ERROR_LOG_RANGE)),
            offset_rad: if has_offset { offset_rad } else { 0.0 },
        }
    }

    fn device(&self, mut noise: Noise) -> PairParameters {
        let rms_rad = self.rms_rad * noise.tolerance((1.0, STRIP_SIGMA));
        PairParameters {
            opposed_rms_rad: rms_rad * libm::sqrt(1.0 - self.shared),
            shared_rms_rad: rms_rad * libm::sqrt(self.shared),
            time_s: self.time_s,
            offset_rad: self.offset_rad,
            bend_rad_per_k: noise.tolerance((0.0, THERMAL_BEND_SIGMA_RAD_PER_K)),
        }
    }
}

/// Common properties of an arm's IMUs.
struct ImuBatch {
    turn_on_rad_per_s: f64,
    instability_rad_per_s: f64,
    acceleration_scale: f64,
}

impl ImuBatch {
    fn new(mut noise: Noise) -> Self {
        Self {
            turn_on_rad_per_s: noise.between(TURN_ON_RANGE_RAD_PER_S),
            instability_rad_per_s: noise.between(INSTABILITY_RANGE_RAD_PER_S),
            acceleration_scale: noise.between(ACCELERATION_SCALE_RANGE),
        }
    }

    fn device(&self, mut noise: Noise) -> ImuParameters {
        ImuParameters {
            sensitivity: 1.0 + noise.between(SENSITIVITY_RANGE),
            pitch_rad: noise.tolerance((0.0, MOUNT_TILT_SIGMA_RAD)),
            roll_rad: noise.tolerance((0.0, MOUNT_TILT_SIGMA_RAD)),
            plane_tilt_rad: noise.between(PLANE_TILT_RANGE_RAD),
            plane_direction_rad: noise.between((-PI, PI)),
            bias_rad_per_s: noise.tolerance((0.0, BIAS_SIGMA_RAD_PER_S)),
            turn_on_rad_per_s: self.turn_on_rad_per_s,
            instability_rad_per_s: self.instability_rad_per_s,
            instability_s: noise.between(INSTABILITY_RANGE_S),
            rate_walk_rad_per_s: noise.between(RATE_WALK_RANGE_RAD_PER_S),
            heading_walk_rad: HEADING_WALK_RAD,
            rate_rad_per_s_per_k: noise.tolerance((0.0, RATE_SIGMA_RAD_PER_S_PER_K)),
            heading_noise_rad: noise.between(HEADING_NOISE_RANGE_RAD),
            error_per_acceleration: self.acceleration_scale * ERROR_PER_ACCELERATION_RAD_S2_PER_M,
            error_per_spin: self.acceleration_scale * ERROR_PER_SPIN_S2,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::arm::ArmParameters;
    use crate::layout::Layout;

    /// An arm of a seed with six segments.
    fn arm(seed: u64) -> ArmParameters {
        super::arm(seed, &Layout::default())
    }

    #[test]
    fn drawn_arms_have_every_flaw_that_the_reference_arm_lacks() {
        for seed in 1..=20 {
            let ArmParameters { regulators, actuators, curves, strips, pairs, imus } = arm(seed);
            let (strip, imu) = (strips[0].expect("it has all sensors"), imus[0].expect("it has all sensors"));
            let flaws = [
                regulators[0].offset_pa,
                actuators[0].gains[0] - actuators[0].gains[1],
                curves[0].length_m - curves[1].length_m,
                curves[0].rest_bend_rad,
                strip.cubic_per_rad2,
                strip.creep_share[1],
                strip.ohm_share_per_k,
                pairs[0].shared_rms_rad,
                pairs[0].bend_rad_per_k,
                imu.plane_tilt_rad,
                imu.turn_on_rad_per_s,
                imu.instability_rad_per_s,
                imu.heading_walk_rad,
                imu.rate_rad_per_s_per_k,
            ];
            assert!(flaws.iter().all(|flaw| flaw.abs() > 0.0), "arm {seed}: {flaws:?}");
        }
    }

    #[test]
    fn strips_stay_on_their_curves() {
        for seed in 1..=200 {
            for strip in arm(seed).strips.into_iter().flatten() {
                assert!(strip.start >= 0.0 && strip.start + strip.length <= 1.0, "arm {seed}: {strip:?}");
            }
        }
    }

    #[test]
    fn a_third_of_the_arms_has_offsets_in_their_sessions() {
        let count = (1..=1000).filter(|&seed| arm(seed).pairs[0].offset_rad > 0.0).count();
        assert!((250..350).contains(&count), "{count} of 1000");
    }
}
