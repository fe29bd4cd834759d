//! State of the bias filter, and its output.

use crate::config::{ArmConfig, BendErrorConfig, SegmentConfig};
use crate::drift::bend_monitor::NEW_ZERO_US;
use crate::drift::bias_filter::tare_statistics::TareStatistics;
use crate::drift::bias_filter::track::{SegmentTrack, since};
use crate::drift::bias_state::BiasState;
use crate::drift::bias_trace::BiasTrace;
use crate::drift::correction::{CorrectedArm, MeasuredAngles};
use crate::drift::rest::RestDetector;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, scaled_square, smaller, variance_deg};
use crate::types::Condition;

/// Variance rate of an absent heading's own error: 0.5° after a second, growing with the square root of time.
const ABSENT: Constant = variance_deg(0.5 * 8.0);
/// Time for which an angle is kept that is not measured, µs and time units.
const UNMEASURED_US: u64 = 500_000;
const UNMEASURED_TIME: Constant = Constant::new(UNMEASURED_US as f64 / 1e6 / TIME_UNIT_S);
/// Standard deviation that such a heading gains: 20° a second, for the arm moves; rad per time unit.
const UNMEASURED_SPEED: Constant = degrees(20.0 * TIME_UNIT_S);

/// State of the bias filter for up to `N` segments, in the number type `F`.
///
/// ```
/// use estimator_core::{
///     ArmConfig, BendMap, BendSensorConfig, BiasFilterConfig, Estimator, ImuReading, Phase, Q, QuadraticMap, Sample,
///     SegmentConfig,
/// };
///
/// // A sensor of 1 rad/V that reads 1.5 V when straight, and is missing now.
/// let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
/// let sensor = BendSensorConfig { map, memory: None };
/// let segments = [SegmentConfig::<Q> { bend: [Some(sensor), None], ..SegmentConfig::uncalibrated(0.080, 0.017) }];
/// let config = ArmConfig { bias_filter: Some(BiasFilterConfig::BNO055), ..ArmConfig::uncalibrated(&segments) };
/// let mut estimator = Estimator::<Q, 1, 100>::new(&config)?;
/// let mut sample = Sample::missing(0);
/// sample.imu[0] = Some(ImuReading::Heading(Phase::from_degrees(30.0)));
/// let theta = estimator.update(&sample)[0].theta.expect("the IMU was read");
/// assert!((theta.rad().to_degrees() - 30.0).abs() < 0.1);
/// # Ok::<(), estimator_core::ConfigError>(())
/// ```
#[derive(Debug, Clone)]
pub struct BiasFilter<F, const N: usize, T = ()> {
    pub(super) state: BiasState<F, N, T>,
    pub(super) tare: TareStatistics<F, N>,
    pub(super) segments: [SegmentTrack<F>; N],
    pub(super) rest: RestDetector<F, N>,
    /// Variance of the resting arm's own creep in a window of rest.
    pub(super) creep: F,
    pub(super) is_started: bool,
    pub(super) is_tare_bad: bool,
    pub(super) last_us: Option<u64>,
    /// Index of the segment to be processed next, and of the segment to be updated next.
    pub(super) next_segment: usize,
    pub(super) next_update: usize,
}

impl<F: Scalar, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// At the start of a session. `zero` and `trace` are parameters so that the constructor is `const` (a static holds
    /// the filter).
    pub const fn new(zero: F, trace: T) -> Self {
        Self {
            state: BiasState::with_trace(zero, trace),
            tare: TareStatistics::new(zero),
            segments: [SegmentTrack::new(zero); N],
            rest: RestDetector::new(zero),
            creep: zero,
            is_started: false,
            is_tare_bad: false,
            last_us: None,
            next_segment: 0,
            next_update: 0,
        }
    }

    /// Clears all state at the start of a session, part by part: a temporary of the whole would not fit a small stack.
    pub fn start(&mut self) {
        let zero = F::zero();
        self.state.clear();
        self.tare = TareStatistics::new(zero);
        for track in &mut self.segments {
            *track = SegmentTrack::new(zero);
        }
        (self.rest, self.creep) = (RestDetector::new(zero), zero);
        (self.is_started, self.is_tare_bad, self.last_us) = (false, false, None);
        (self.next_segment, self.next_update) = (0, 0);
    }

    /// The trace of the operations on the states.
    pub fn trace_mut(&mut self) -> &mut T {
        self.state.trace_mut()
    }

    /// Covariances of heading `i` with all headings, [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times rad².
    pub fn heading_covariances(&self, i: usize) -> impl Iterator<Item = F> {
        self.state.bias_covariances(i)
    }

    /// Variance of heading `i` in addition to that of its bias: that of the bend sensors for an absent heading, else
    /// zero.
    pub fn absence_variance(&self, config: &BendErrorConfig, i: usize) -> F {
        let Some(track) = self.segments.get(i).filter(|track| !track.is_heading_read) else { return F::zero() };
        let now_us = self.last_us.unwrap_or(0);
        let grown = smaller(since(track.heading_read_at_us, now_us), F::one()) * F::constant(ABSENT);
        let by_bend = smaller(grown, track.offset_prior + F::from_q(config.mean));
        let unmeasured = smaller(since(track.heading_measured_at_us, now_us), F::constant(UNMEASURED_TIME));
        by_bend + scaled_square(unmeasured * F::constant(UNMEASURED_SPEED))
    }

    /// Returns `true` once the tare is complete, so that the covariance is known.
    pub fn is_started(&self) -> bool {
        self.is_started
    }

    /// Condition of segment `i`.
    pub fn condition(&self, i: usize) -> Condition {
        let Some(track) = self.segments.get(i).filter(|_| self.is_started) else { return Condition::default() };
        let now_us = self.last_us.unwrap_or_default();
        let mut bend_implausible = track.monitor.implausible(now_us);
        for (implausible, is_outside) in bend_implausible.iter_mut().zip(track.is_outside) {
            *implausible |= is_outside;
        }
        Condition {
            tare_bad: self.is_tare_bad,
            imu_absent: !track.is_heading_read,
            imu_restarted: track.restarted_at_us.is_some_and(|at_us| now_us.saturating_sub(at_us) < NEW_ZERO_US),
            bend_distrusted: track.is_bend_missing || track.monitor.has_suspect() || bend_implausible.contains(&true),
            gated: track.gated_since_us.is_some(),
            imu_implausible: track.has_reading && !track.is_heading_read,
            bend_implausible,
        }
    }

    /// θ of all segments, from their headings; none of a segment that has not been measured for a while.
    pub(super) fn angles<S>(&mut self, segments: &[SegmentConfig<S>], time_us: u64, corrected: &mut CorrectedArm<N>) {
        let (mut below, mut is_below_read, mut steps_below) = (Turns::ZERO, true, Turns::ZERO);
        let angles = corrected.fused.iter_mut().zip(&mut corrected.imu).zip(&mut corrected.measured);
        for (track, ((fused, imu), measured)) in self.segments.iter_mut().zip(angles).take(segments.len()) {
            let theta = Turns::from((track.heading - below).phase());
            track.theta = F::from_phase(theta.phase());
            *fused = (time_us.saturating_sub(track.theta_measured_at_us) < UNMEASURED_US).then_some(theta);
            *imu = (track.is_heading_read && is_below_read).then_some(theta);
            let steps = track.bias_steps - steps_below;
            let bend = track.bend.map(|bend| bend.theta.to_turns());
            *measured = MeasuredAngles { imu: imu.map(|theta| theta - steps), steps, bend };
            (below, is_below_read, steps_below) = (track.heading, track.is_heading_read, track.bias_steps);
        }
    }
}

impl<F: FusedOps, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// Returns `true` while block rows of the covariance remain to be updated.
    pub fn is_updating(&self) -> bool {
        self.state.is_updating()
    }

    /// Updates the next block row of the covariance.
    pub fn update_covariance_row(&mut self) {
        self.state.update_row();
    }

    /// Updates all remaining block rows of the covariance.
    pub fn finish_covariance(&mut self) {
        self.state.finish_update();
    }
}

/// Number of segments processed in one sample: each segment at least ten times a second.
pub(super) fn segments_per_sample<S>(config: &ArmConfig<S>) -> u32 {
    let (count, rate_millihertz) = (config.segments.len() as u32, config.anchor.sample_rate_millihertz.max(1));
    (10_000 * count).div_ceil(rate_millihertz).min(count)
}

/// The segment that follows `i` in turn.
pub(super) fn following<S>(i: usize, segments: &[SegmentConfig<S>]) -> usize {
    if i + 1 < segments.len() { i + 1 } else { 0 }
}
