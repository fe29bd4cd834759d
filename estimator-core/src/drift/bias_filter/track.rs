//! Per-segment state of the bias filter.

use crate::config::SENSORS_PER_SEGMENT;
use crate::drift::bend_monitor::{BendMonitor, TrustedBend};
use crate::drift::heading_gate::HeadingGate;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::Scalar;
use crate::sensing::bend_sensors::BendAngles;

/// Largest factor on the measurement noise; beyond it a measurement is ignored.
pub(super) const MAX_RATIO: i32 = 15;

/// Changes of one heading and bend angle over a window of rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct RestChange<F> {
    pub heading: F,
    pub bend: F,
    pub length_us: u64,
}

/// Per-segment state.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "independent conditions")]
pub(super) struct SegmentTrack<F> {
    pub gate: HeadingGate<F>,
    pub monitor: BendMonitor<F>,
    /// Number of bend sensors that the segment has.
    pub sensors: usize,
    /// Heading of the segment's end in {W}.
    pub heading: Turns,
    /// Bias by which the heading is corrected.
    pub bias: Turns,
    /// Sum of the steps of the heading that updates of the biases have caused.
    pub bias_steps: Turns,
    /// θ of the last sample, and when the segment was last processed, rad.
    pub theta: F,
    pub processed_theta: F,
    pub processed_at_us: Option<u64>,
    /// Mean of θ over the last minutes, rad.
    pub mean_theta: F,
    /// θ_bend less its reference in the tare, until the segment's first update, rad.
    pub tare_bend: Option<F>,
    /// Change over a window of rest, until the segment's next update.
    pub rest: Option<RestChange<F>>,
    /// θ_bend of this sample.
    pub bend: Option<TrustedBend<F>>,
    /// θ_bend of the last sample that had one, rad.
    pub last_bend: Option<F>,
    /// Motion of the bend sensors since that sample, rad.
    pub motion: F,
    pub is_heading_read: bool,
    pub heading_read_at_us: u64,
    /// When the heading was measured last: read, or known from another one by bend sensors; and when θ was.
    pub heading_measured_at_us: u64,
    pub theta_measured_at_us: u64,
    /// θ and θ_bend up to which travel has been counted, and the travel since the last update, rad.
    pub counted_theta: F,
    pub counted_bend: F,
    pub travelled: F,
    pub updated_at_us: u64,
    pub gated_since_us: Option<u64>,
    pub restarted_at_us: Option<u64>,
    /// Bend sensors whose counts are outside their calibration.
    pub is_outside: [bool; SENSORS_PER_SEGMENT],
    /// The IMU was read, whether or not its heading was used.
    pub has_reading: bool,
    /// Variance of the offset: from the tare, the prior's, and the part of the prior that lost sensors have added.
    pub session_offset: F,
    pub offset_prior: F,
    pub lost_sensor_variance: F,
    /// One sensor of two is missing.
    pub is_single: bool,
    /// At least one bend sensor is missing.
    pub is_bend_missing: bool,
}

impl<F: Scalar> SegmentTrack<F> {
    pub const fn new(zero: F) -> Self {
        Self {
            gate: HeadingGate::new(zero),
            monitor: BendMonitor::new(zero),
            sensors: 0,
            heading: Turns::ZERO,
            bias: Turns::ZERO,
            bias_steps: Turns::ZERO,
            theta: zero,
            processed_theta: zero,
            processed_at_us: None,
            mean_theta: zero,
            tare_bend: None,
            rest: None,
            bend: None,
            last_bend: None,
            motion: zero,
            is_heading_read: false,
            heading_read_at_us: 0,
            heading_measured_at_us: 0,
            theta_measured_at_us: 0,
            counted_theta: zero,
            counted_bend: zero,
            travelled: zero,
            updated_at_us: 0,
            gated_since_us: None,
            restarted_at_us: None,
            is_outside: [false; SENSORS_PER_SEGMENT],
            has_reading: false,
            session_offset: zero,
            offset_prior: zero,
            lost_sensor_variance: zero,
            is_single: false,
            is_bend_missing: false,
        }
    }

    /// Returns `true` if the segment has two bend sensors.
    pub fn has_twins(&self) -> bool {
        self.sensors > 1
    }

    /// Angles of the bend sensors, corrected for steps.
    pub fn sensor_angles<S: Scalar>(&self, bend: &BendAngles<S>) -> [Option<F>; SENSORS_PER_SEGMENT] {
        self.monitor.corrected(bend.sensors.map(|theta| theta.map(|theta| F::from_q(theta.to_q()))))
    }

    /// Updates θ_bend and its motion from the angles of the bend sensors.
    pub fn update_bend(&mut self, angles: [Option<F>; SENSORS_PER_SEGMENT], time_us: u64) {
        self.bend = self.monitor.mean(angles, self.has_twins(), time_us);
        self.motion = self.bend.zip(self.last_bend).map_or(F::zero(), |(now, last)| now.theta - last);
    }
}

/// Time from `from_us` to `to_us`, time units.
pub(super) fn since<F: Scalar>(from_us: u64, to_us: u64) -> F {
    F::from_micros(to_us.saturating_sub(from_us).min(u64::from(u32::MAX)) as u32)
}

/// `a / b`, at most [`MAX_RATIO`].
pub(super) fn bounded_ratio<F: Scalar>(a: F, b: F) -> F {
    let largest = F::from_int(MAX_RATIO);
    if b > a / largest { a / b } else { largest }
}
