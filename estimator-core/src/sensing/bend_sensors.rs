//! The bend sensors of one segment: counts to angles, with compensation of creep and hysteresis.

use crate::config::{SENSORS_PER_SEGMENT, SegmentConfig};
use crate::numeric::fused::FusedOps;
use crate::numeric::q::Q;
use crate::sensing::hysteresis::{Memory, PrandtlIshlinskii};

/// State of a segment's bend sensors.
#[derive(Debug, Clone, Copy)]
pub struct BendSensors<S> {
    /// In fixed point for every `S`: the recursion rounds, and all number types must have the same angles.
    memory: [Memory<Q>; SENSORS_PER_SEGMENT],
    hysteresis: PrandtlIshlinskii<S>,
}

/// Bend angles of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendAngles<S> {
    /// Angle of each sensor that was read, rad.
    pub sensors: [Option<S>; SENSORS_PER_SEGMENT],
    /// The sensor was read, but its counts are so far outside its calibration that they give no angle.
    pub is_outside: [bool; SENSORS_PER_SEGMENT],
    /// θ_bend,i, their mean, hysteresis compensated, rad.
    pub mean: Option<S>,
    /// A sensor reads outside the range of its calibration.
    pub is_extrapolated: bool,
}

impl<S> BendAngles<S> {
    /// No sensor was read.
    pub const UNKNOWN: Self = Self {
        sensors: [const { None }; SENSORS_PER_SEGMENT],
        is_outside: [false; SENSORS_PER_SEGMENT],
        mean: None,
        is_extrapolated: false,
    };
}

impl<S: FusedOps> BendSensors<S> {
    /// Before the first reading.
    pub const fn new() -> Self {
        Self { memory: [Memory::new(); SENSORS_PER_SEGMENT], hysteresis: PrandtlIshlinskii::new() }
    }

    /// Writes the bend `angles` at these counts, read at `time_us`; the creep states are updated if `is_followed`.
    pub fn read(
        &mut self,
        angles: &mut BendAngles<S>,
        config: &SegmentConfig<S>,
        counts: [Option<u16>; SENSORS_PER_SEGMENT],
        time_us: u64,
        is_followed: bool,
    ) {
        angles.is_extrapolated = false;
        let outputs = angles.sensors.iter_mut().zip(&mut angles.is_outside);
        let sensors = config.bend.iter().zip(counts).zip(&mut self.memory).zip(outputs);
        for (((sensor, counts), memory), (angle, is_outside)) in sensors {
            (*angle, *is_outside) = (None, false);
            let (Some(sensor), Some(counts)) = (sensor, counts) else { continue };
            let mapped = sensor.map.angle(counts);
            *is_outside = mapped.is_none();
            *angle = match (mapped, &sensor.memory) {
                (Some(theta), Some(config)) => {
                    Some(theta + S::from_q(memory.correction(config, theta.to_q(), time_us, is_followed)))
                }
                (mapped, _) => mapped,
            };
            angles.is_extrapolated |= sensor.map.is_extrapolated(counts);
        }
        let mean = mean(angles.sensors);
        angles.mean = match &config.hysteresis {
            Some(plays) => mean.map(|theta| self.hysteresis.compensate(plays, theta)),
            None => mean,
        };
    }
}

impl<S: Copy> BendAngles<S> {
    /// Number of sensors that were read.
    pub fn count(&self) -> u8 {
        self.sensors.iter().map(|sensor| u8::from(sensor.is_some())).sum()
    }
}

/// Mean of the sensors that were read.
fn mean<S: FusedOps>([a, b]: [Option<S>; SENSORS_PER_SEGMENT]) -> Option<S> {
    match (a, b) {
        (Some(a), Some(b)) => Some((a + b).half()),
        (one, other) => one.or(other),
    }
}
