//! Random but realistic sessions: an arm with random geometry and maps, smooth motion, drift, noise and outages.

use std::f64::consts::{PI, TAU};

use estimator_core::{
    AnchorConfig, BendMap, BendSensorConfig, FusedOps, KalmanParams, OffsetAt, Phase, QuadraticMap, Sample,
    SegmentConfig, Turns,
};
use host_tests::reference_model;

/// Volts between which all sensors are calibrated.
const VOLTS: [f64; 2] = [0.4, 2.6];

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn log_within(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    /// Half of the time 0.
    pub fn or_zero(&mut self, low: f64, high: f64) -> f64 {
        if self.chance(0.5) { 0.0 } else { self.within(low, high) }
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.bits() as usize % from.len()]
    }
}

/// Properties of a session; the rest is drawn from `seed`.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    pub seed: u64,
    pub segments: usize,
    pub rate: f64,
    pub tare_seconds: f64,
    pub rows: usize,
    /// True if headings are quaternions.
    pub quaternions: bool,
    /// Fewest and most bend sensors that a segment has.
    pub bend: [u64; 2],
    /// Largest drift of the session's IMUs, rad; all to one side.
    pub drift: f64,
    pub noise: NoiseRanges,
}

/// Least and greatest filter parameters, with Q per row, and Q and R_imu as ratios to R_bend.
#[derive(Debug, Clone, Copy)]
pub struct NoiseRanges {
    pub q: [f64; 2],
    pub r_imu: [f64; 2],
    pub h: [f64; 2],
}

/// An arm with random geometry, maps and filters.
pub fn arm(kind: &Kind, random: &mut Random) -> reference_model::Arm {
    let mut heading = 0.0;
    let segments = (0..kind.segments).map(|i| {
        let [fewest, most] = kind.bend;
        let fewest = if i == 0 { fewest.max(most.min(1)) } else { fewest }; // or the arm could be without any
        let sensors = fewest + random.bits() % (most - fewest + 1);
        heading += random.or_zero(-0.3, 0.3);
        reference_model::Segment {
            length: random.within(0.03, 0.12),
            offset: random.or_zero(0.005, 0.03),
            offset_at_end: random.chance(0.5),
            bend: (0..sensors).map(|_| sensor(random)).collect(),
            reference: heading,
            orient: noise(kind, random, 1e-3, 1e-2),
            coord: noise(kind, random, 1e-6, 1e-4),
        }
    });
    reference_model::Arm {
        segments: segments.collect(),
        rate: kind.rate,
        tare_seconds: kind.tare_seconds,
        window: random.pick(&[10, 30, 100]),
        threshold: 0.5_f64.to_radians(),
        anchor_rate: random.pick(&[10.0, 10.0, kind.rate, 4.0]),
    }
}

/// A monotonic map that is near 0 at the middle of the range.
fn sensor(random: &mut Random) -> reference_model::Sensor {
    let (c1, c2) = (random.within(1.0, 1.6), random.within(-0.15, 0.15));
    let c0 = -(c2 * 1.5 + c1) * 1.5 + random.within(-0.1, 0.1);
    let sign = random.pick(&[1.0, -1.0]);
    reference_model::Sensor { c2: sign * c2, c1: sign * c1, c0: sign * c0 }
}

fn noise(kind: &Kind, random: &mut Random, low: f64, high: f64) -> reference_model::Noise {
    let NoiseRanges { q, r_imu, h } = kind.noise;
    let r_bend = random.log_within(low, high);
    reference_model::Noise {
        q: r_bend * random.log_within(q[0], q[1]) * kind.rate,
        r_imu: r_bend * random.log_within(r_imu[0], r_imu[1]),
        r_bend,
        h_imu: random.within(h[0], h[1]),
        h_bend: random.within(h[0], h[1]),
    }
}

/// The motion of such an arm as its sensors measure it: rows for the reference model, and the same as samples of the board.
pub fn session(
    kind: &Kind,
    arm: &reference_model::Arm,
    random: &mut Random,
) -> (Vec<reference_model::Row>, Vec<Sample<16>>) {
    let drift = kind.drift * random.pick(&[1.0, -1.0]);
    let mut imus: Vec<_> = arm.segments.iter().map(|_| Imu::new(kind, drift, random)).collect();
    let mut bends: Vec<_> = arm.segments.iter().map(|_| [Outage::default(); 2]).collect();
    let waves: Vec<[f64; 3]> = arm
        .segments
        .iter()
        .map(|_| [random.within(0.1, 1.1), random.within(0.1, 1.5), random.within(0.0, TAU)])
        .collect();
    let mut rows = Vec::new();
    let mut samples = Vec::new();
    for t in 0..kind.rows {
        let seconds = t as f64 / kind.rate;
        let moving = (seconds - kind.tare_seconds).clamp(0.0, 1.0);
        let mut row = reference_model::Row::default();
        let mut sample = Sample::missing((seconds * 1e6) as u64);
        let (mut heading, mut reference) = (0.0, 0.0);
        for (i, segment) in arm.segments.iter().enumerate() {
            let [amplitude, frequency, phase] = waves[i];
            let at_rest = if kind.tare_seconds > 0.0 { segment.reference - reference } else { 0.0 };
            let theta = at_rest + moving * amplitude * (frequency * seconds + phase).sin();
            (heading, reference) = (heading + theta, segment.reference);
            let reading = imus[i].read(heading, t, arm, random);
            row.headings.push(reading);
            sample.imu[i] = reading.map(|heading| board_reading(kind, heading, random));
            let mut counts = [None; 2];
            for (k, sensor) in segment.bend.iter().enumerate() {
                let measured = theta + random.within(-0.08, 0.08);
                counts[k] = bends[i][k].passes(t, arm, random).then(|| counts_at(sensor, measured));
            }
            row.counts.push(counts);
            sample.bend[i] = counts;
        }
        rows.push(row);
        samples.push(sample);
    }
    (rows, samples)
}

/// An IMU with its mounting angle, drift and outages.
struct Imu {
    mount: f64,
    drift_per_row: f64,
    outage: Outage,
}

impl Imu {
    fn new(kind: &Kind, drift: f64, random: &mut Random) -> Self {
        // Absolute headings need no mounting angle.
        let mount = if kind.tare_seconds > 0.0 { random.within(-PI, PI) } else { 0.0 };
        let drift = drift * random.pick(&[0.0, 0.02, 0.1, 1.0]);
        Self { mount, drift_per_row: drift / kind.rows as f64, outage: Outage::default() }
    }

    /// Heading in [0, 2π).
    fn read(&mut self, heading: f64, t: usize, arm: &reference_model::Arm, random: &mut Random) -> Option<f64> {
        let reading = heading + self.mount + self.drift_per_row * t as f64 + random.within(-0.01, 0.01);
        self.outage.passes(t, arm, random).then(|| reading.rem_euclid(TAU))
    }
}

/// Outages of a sensor, rarely longer than the anchor's window.
#[derive(Clone, Copy, Default)]
struct Outage {
    until: usize,
}

impl Outage {
    fn passes(&mut self, t: usize, arm: &reference_model::Arm, random: &mut Random) -> bool {
        if t >= self.until && random.chance(0.01) {
            let window = arm.window as f64 * arm.rate / arm.anchor_rate;
            let long = if random.chance(0.03) { 1.5 * window } else { 10.0 };
            self.until = t + random.within(1.0, long.max(2.0)) as usize;
        }
        t >= self.until
    }
}

/// Counts of the ADC at a bend angle.
fn counts_at(sensor: &reference_model::Sensor, theta: f64) -> u16 {
    let angle = |volts: f64| (sensor.c2 * volts + sensor.c1) * volts + sensor.c0;
    let rising = sensor.c1 > 0.0;
    let (mut low, mut high) = (0.0, 3.3);
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if (angle(middle) < theta) == rising { low = middle } else { high = middle }
    }
    (low / 3.3 * 4095.0).round() as u16
}

/// A heading as the board reads it; as a quaternion also tilted about the IMU's own x axis, which turns no heading.
fn board_reading(kind: &Kind, heading: f64, random: &mut Random) -> estimator_core::ImuReading {
    if !kind.quaternions {
        return estimator_core::ImuReading::Heading(Phase::from_rad(heading));
    }
    let ((sz, cz), (sx, cx)) = ((-heading / 2.0).sin_cos(), random.within(-0.1, 0.1).sin_cos());
    let quaternion = [cz * cx, cz * sx, sz * sx, sz * cx];
    estimator_core::ImuReading::Quaternion(quaternion.map(|part| (part * f64::from(1 << 30)).round() as i32))
}

/// The arm's segments as the estimator takes them: process noise per sample, covariances as ratios to the larger R.
pub fn segments<S: FusedOps>(arm: &reference_model::Arm) -> Vec<SegmentConfig<S>> {
    let noise = |noise: &reference_model::Noise| {
        let unit = noise.r_imu.max(noise.r_bend);
        KalmanParams {
            q: S::from_f64(noise.q / arm.rate / unit),
            r_imu: S::from_f64(noise.r_imu / unit),
            r_bend: S::from_f64(noise.r_bend / unit),
            h_imu: S::from_f64(noise.h_imu),
            h_bend: S::from_f64(noise.h_bend),
        }
    };
    let segment = |segment: &reference_model::Segment| {
        let sensor = |k: usize| {
            let map =
                |s: &reference_model::Sensor| BendMap::Quadratic(QuadraticMap::from_volts(s.c2, s.c1, s.c0, VOLTS));
            segment.bend.get(k).map(|s| BendSensorConfig { map: map(s), memory: None })
        };
        SegmentConfig {
            offset_at: if segment.offset_at_end { OffsetAt::End } else { OffsetAt::Start },
            bend: [sensor(0), sensor(1)],
            reference: Turns::from_rad(segment.reference),
            orient: noise(&segment.orient),
            coord: noise(&segment.coord),
            ..SegmentConfig::uncalibrated(segment.length, segment.offset)
        }
    };
    arm.segments.iter().map(segment).collect()
}

/// The anchor's rule and the tare in samples.
pub fn rule(arm: &reference_model::Arm) -> (AnchorConfig, u32) {
    let anchor = AnchorConfig {
        window: arm.window as u16,
        rate_millihertz: (arm.anchor_rate * 1000.0) as u32,
        sample_rate_millihertz: (arm.rate * 1000.0) as u32,
        threshold: Turns::from_rad(arm.threshold),
    };
    (anchor, (arm.rate * arm.tare_seconds).round() as u32)
}
