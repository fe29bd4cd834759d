//! A small simulated arm: three segments that bend like sines, with drifting IMUs and bend sensors that are off.

#![allow(dead_code, reason = "each test program uses a part of it")]

use std::f64::consts::TAU;

use estimator_core::{
    AnchorConfig, ArmConfig, BendErrorConfig, BendMap, BendSensorConfig, BiasFilterConfig, ContactConfig, FusedOps,
    ImuReading, Phase, Q, QuadraticMap, Sample, SegmentConfig, Turns, UncertaintyConfig, VARIANCE_SCALE,
};

/// Segments of the arm.
pub const N: usize = 3;

/// A motion and the errors of all sensors, in degrees and seconds.
#[derive(Clone)]
pub struct Arm {
    /// Samples a second.
    pub rate_hz: f64,
    /// Largest bend of each segment.
    pub amplitude: [f64; N],
    /// Period of each segment.
    pub period: [f64; N],
    /// Bend of each segment while the arm rests.
    pub rest: [f64; N],
    /// The arm rests until then.
    pub rest_until: f64,
    /// Drift of each IMU, °/s.
    pub drift: [f64; N],
    /// Offset of the bend sensors of each segment.
    pub bend_offset: [f64; N],
    /// Error of the bend sensors' maps: this much at most, as a sine of the bend.
    pub map_error: f64,
    /// Half the width of the IMUs' noise.
    pub imu_noise: f64,
    /// State of the noise.
    pub noise: u64,
}

/// A heading, turned by this.
pub fn turned(reading: Option<ImuReading>, degrees: f64) -> Option<ImuReading> {
    let Some(ImuReading::Heading(heading)) = reading else { return reading };
    let by = Phase::from_degrees(degrees).bits();
    Some(ImuReading::Heading(Phase::from_bits(heading.bits().wrapping_add(by))))
}

impl Default for Arm {
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            amplitude: [40.0, 30.0, 35.0],
            period: [7.0, 5.0, 11.0],
            rest: [0.0; N],
            rest_until: 1.5,
            drift: [0.0; N],
            bend_offset: [0.0; N],
            map_error: 1.5,
            imu_noise: 0.1,
            noise: 1,
        }
    }
}

impl Arm {
    /// Bend angle of each segment at a time.
    pub fn theta(&self, seconds: f64) -> [f64; N] {
        let since = (seconds - self.rest_until).max(0.0);
        let begin = (since / 2.0).min(1.0);
        core::array::from_fn(|i| {
            self.rest[i] + begin * self.amplitude[i] * (TAU * since / self.period[i] + i as f64).sin()
        })
    }

    /// Time of a sample.
    pub fn seconds(&self, k: u64) -> f64 {
        k as f64 / self.rate_hz
    }

    fn noise(&mut self) -> f64 {
        self.noise = self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.noise >> 33) as i32) / f64::from(1 << 30) - 1.0
    }

    /// Sample number `k`, from a board that has run for 100 s.
    pub fn sample<const ROOM: usize>(&mut self, k: u64) -> Sample<ROOM> {
        let seconds = self.seconds(k);
        let mut sample = Sample::missing(100_000_000 + (seconds * 1e6) as u64);
        let mut heading = 0.0;
        for (i, theta) in self.theta(seconds).into_iter().enumerate() {
            heading += theta;
            let bend = theta + self.bend_offset[i] + self.map_error * (theta / 10.0 + i as f64).sin();
            sample.bend[i] = [bend + 0.5, bend - 0.5].map(|degrees| Some(counts(degrees)));
            let read = heading + self.drift[i] * seconds + self.imu_noise * self.noise();
            sample.imu[i] = Some(ImuReading::Heading(Phase::from_degrees((read * 16.0).round() / 16.0)));
        }
        sample
    }
}

/// Counts of a sensor of 1 rad/V that reads 1.5 V when straight.
pub fn counts(degrees: f64) -> u16 {
    ((degrees.to_radians() + 1.5) / 3.3 * 4095.0).round() as u16
}

/// Its V–Orient map.
pub fn sensor<S: FusedOps>() -> BendSensorConfig<S> {
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
    BendSensorConfig { map, memory: None }
}

/// Variance of a deviation in degrees, as configurations hold it.
pub fn variance(degrees: f64) -> Q {
    Q::from_f64(degrees.to_radians().powi(2) * VARIANCE_SCALE)
}

/// Segments with two bend sensors each, whose errors were measured.
pub fn segments<S: FusedOps>() -> [SegmentConfig<S>; N] {
    let bend_error = BendErrorConfig {
        mean: variance(2.0),
        sensor: [variance(2.5); 2],
        difference: variance(1.0),
        ..BendErrorConfig::PAPER
    };
    [SegmentConfig { bend: [Some(sensor()); 2], bend_error, ..SegmentConfig::uncalibrated(0.080, 0.017) }; N]
}

/// Configuration with the bias filter, a tare of one second, contact detection and covariance.
pub fn config<S>(segments: &[SegmentConfig<S>], rate_hz: f64) -> ArmConfig<'_, S> {
    let degrees = |degrees: f64| Turns::from_rad(degrees.to_radians());
    let anchor =
        AnchorConfig { sample_rate_millihertz: (rate_hz * 1e3) as u32, ..ArmConfig::uncalibrated(segments).anchor };
    ArmConfig {
        tare_samples: rate_hz as u32,
        anchor,
        bias_filter: Some(BiasFilterConfig::BNO055),
        contact: Some(ContactConfig { bend: degrees(8.0), coupling: degrees(6.0) }),
        uncertainty: Some(UncertaintyConfig {
            theta: variance(1.0),
            bias_share: Q::from_f64(1.0),
            bend: variance(3.0),
            contact: variance(3.0),
            heading: variance(0.3),
            end: Q::from_f64(1e-7 * VARIANCE_SCALE),
        }),
        ..ArmConfig::uncalibrated(segments)
    }
}
