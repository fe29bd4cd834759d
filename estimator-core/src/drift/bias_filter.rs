//! The bias filter: drift correction by a Kalman filter over all headings, with bend sensors that may be wrong.
//!
//! Stages: trusted bend angles, plausible headings, absent headings from their neighbours, then one segment's update of
//! the [model](super::bias_state) in each sample, and the rules for rest. All limits are times, not numbers of samples.
//!
//! The bend sensors' error depends on their path (map, hysteresis) and is not white in time. Measurements are therefore
//! independent per travel, not per time: an arm at rest gives no new information about the bias.

mod headings;
mod tare;
mod update;

pub use headings::ABSENT_TIME_S;

use crate::config::{ArmConfig, BendErrorConfig, SENSORS_PER_SEGMENT, SegmentConfig};
use crate::drift::bend_monitor::{BendMonitor, TrustedBend};
use crate::drift::bias_filter::tare::TareStatistics;
use crate::drift::bias_state::BiasState;
use crate::drift::bias_trace::{BiasOperation, BiasTrace};
use crate::drift::heading_gate::HeadingGate;
use crate::drift::rest::RestDetector;
use crate::drift::share::Share;
use crate::drift::{CorrectedArm, DriftCorrection, MeasuredAngles, SensedArm};
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{smaller, variance_deg};
use crate::types::Condition;

/// Variance rate of an absent heading's own error: 0.5° after a second, growing with the square root of time.
const ABSENT: Constant = variance_deg(0.5 * 8.0);
/// Time for which a restart of an IMU and a step of a bend sensor are reported.
const RECENT_US: u64 = 60_000_000;
/// Largest factor on the measurement noise; beyond it a measurement is ignored.
const MAX_RATIO: i32 = 15;

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
    state: BiasState<F, N, T>,
    tare: TareStatistics<F, N>,
    segments: [SegmentTrack<F>; N],
    rest: RestDetector<F, N>,
    is_started: bool,
    is_tare_bad: bool,
    last_us: Option<u64>,
    /// Index of the segment to be processed next, and of the segment to be updated next.
    turn: usize,
    next_update: usize,
}

/// Changes of one heading and bend angle over a window of rest.
#[derive(Debug, Clone, Copy)]
struct RestChange<F> {
    heading: F,
    bend: F,
    length_us: u64,
}

/// Per-segment state.
#[derive(Debug, Clone, Copy)]
struct SegmentTrack<F> {
    gate: HeadingGate<F>,
    monitor: BendMonitor<F>,
    /// Number of bend sensors that the segment has.
    sensors: usize,
    /// Heading of the segment's end in {W}.
    heading: Turns,
    /// Bias by which the heading is corrected.
    bias: Turns,
    /// Sum of the steps of the heading that updates of the biases have caused.
    bias_steps: Turns,
    /// θ of the last sample, and when the segment was last processed, rad.
    theta: F,
    turn_theta: F,
    turned_at_us: Option<u64>,
    /// Mean of θ over the last minutes, rad.
    lean: F,
    /// θ_bend less its reference in the tare, until the segment's first update, rad.
    tare_bend: Option<F>,
    /// Change over a window of rest, until the segment's next update.
    rest: Option<RestChange<F>>,
    /// θ_bend of this sample.
    bend: Option<TrustedBend<F>>,
    /// θ_bend of the last sample that had one, rad.
    last_bend: Option<F>,
    /// Motion of the bend sensors since that sample, rad.
    motion: F,
    is_heading_read: bool,
    heading_read_at_us: u64,
    /// θ and θ_bend up to which travel has been counted, and the travel since the last update, rad.
    counted_theta: F,
    counted_bend: F,
    travelled: F,
    updated_at_us: u64,
    gated_since_us: Option<u64>,
    restarted_at_us: Option<u64>,
    stepped_at_us: Option<u64>,
    /// Variance of the offset: from the tare, the prior's, and the part of the prior that lost sensors have added.
    session_offset: F,
    offset_prior: F,
    lost: F,
    /// One sensor of two is missing.
    is_single: bool,
    /// At least one bend sensor is missing.
    is_bend_missing: bool,
}

impl<F: Scalar> SegmentTrack<F> {
    const fn new(zero: F) -> Self {
        Self {
            gate: HeadingGate::new(zero),
            monitor: BendMonitor::new(zero),
            sensors: 0,
            heading: Turns::ZERO,
            bias: Turns::ZERO,
            bias_steps: Turns::ZERO,
            theta: zero,
            turn_theta: zero,
            turned_at_us: None,
            lean: zero,
            tare_bend: None,
            rest: None,
            bend: None,
            last_bend: None,
            motion: zero,
            is_heading_read: false,
            heading_read_at_us: 0,
            counted_theta: zero,
            counted_bend: zero,
            travelled: zero,
            updated_at_us: 0,
            gated_since_us: None,
            restarted_at_us: None,
            stepped_at_us: None,
            session_offset: zero,
            offset_prior: zero,
            lost: zero,
            is_single: false,
            is_bend_missing: false,
        }
    }

    /// Returns `true` if the segment has two bend sensors.
    fn has_twins(&self) -> bool {
        self.sensors > 1
    }

    /// Updates θ_bend and its motion from the angles of the bend sensors.
    fn take_bend(&mut self, angles: [Option<F>; SENSORS_PER_SEGMENT], time_us: u64) {
        self.bend = self.monitor.mean(angles, self.has_twins(), time_us);
        self.motion = self.bend.zip(self.last_bend).map_or(F::zero(), |(now, last)| now.theta - last);
    }
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
            is_started: false,
            is_tare_bad: false,
            last_us: None,
            turn: 0,
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
        self.rest = RestDetector::new(zero);
        (self.is_started, self.is_tare_bad, self.last_us) = (false, false, None);
        (self.turn, self.next_update) = (0, 0);
    }

    /// The trace of the operations on the states.
    pub fn trace_mut(&mut self) -> &mut T {
        self.state.trace_mut()
    }

    /// Covariance of heading `i` with all headings, [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times rad².
    pub fn heading_covariance(&self, i: usize) -> [F; N] {
        self.state.bias_covariance(i)
    }

    /// Variance of heading `i` in addition to that of its bias: that of the bend sensors for an absent heading, else
    /// zero.
    pub fn absence_variance(&self, config: &BendErrorConfig, i: usize) -> F {
        let Some(track) = self.segments.get(i).filter(|track| !track.is_heading_read) else { return F::zero() };
        let absent = since(track.heading_read_at_us, self.last_us.unwrap_or(0));
        let grown = smaller(absent, F::one()) * F::constant(ABSENT);
        smaller(grown, track.offset_prior + F::from_q(config.mean))
    }

    /// Returns `true` once the tare is complete, so that the covariance is known.
    pub fn is_started(&self) -> bool {
        self.is_started
    }

    /// Condition of segment `i`.
    pub fn condition(&self, i: usize) -> Condition {
        let Some(track) = self.segments.get(i).filter(|_| self.is_started) else { return Condition::default() };
        let now_us = self.last_us.unwrap_or_default();
        let is_recent = |at_us: Option<u64>| at_us.is_some_and(|at_us| now_us.saturating_sub(at_us) < RECENT_US);
        Condition {
            tare_bad: self.is_tare_bad,
            imu_absent: !track.is_heading_read,
            imu_restarted: is_recent(track.restarted_at_us),
            bend_distrusted: track.monitor.is_distrusted(now_us)
                || track.is_bend_missing
                || is_recent(track.stepped_at_us),
            gated: track.gated_since_us.is_some(),
        }
    }

    /// θ of all segments, from their headings.
    fn angles<S>(&mut self, segments: &[SegmentConfig<S>]) -> CorrectedArm<N> {
        let mut corrected = CorrectedArm::UNKNOWN;
        let (mut below, mut is_below_read, mut steps_below) = (Turns::ZERO, true, Turns::ZERO);
        let angles = corrected.fused.iter_mut().zip(&mut corrected.imu).zip(&mut corrected.measured);
        for (track, ((fused, imu), measured)) in self.segments.iter_mut().zip(angles).take(segments.len()) {
            let theta = Turns::from((track.heading - below).phase());
            track.theta = F::from_phase(theta.phase());
            *fused = Some(theta);
            *imu = (track.is_heading_read && is_below_read).then_some(theta);
            let steps = track.bias_steps - steps_below;
            let bend = track.bend.map(|bend| bend.theta.to_turns());
            *measured = MeasuredAngles { imu: imu.map(|theta| theta - steps), steps, bend };
            (below, is_below_read, steps_below) = (track.heading, track.is_heading_read, track.bias_steps);
        }
        corrected
    }
}

impl<F: FusedOps, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// Returns `true` while block rows of the covariance remain to be updated.
    pub fn is_updating(&self) -> bool {
        self.state.is_updating()
    }

    /// Updates the next block row of the covariance.
    pub fn reduce_covariance(&mut self) {
        self.state.reduce_row();
    }

    /// Updates all remaining block rows of the covariance.
    pub fn finish_covariance(&mut self) {
        self.state.finish_update();
    }
}

impl<S: Scalar, F: FusedOps, const N: usize, T: BiasTrace<F>> DriftCorrection<S, N> for BiasFilter<F, N, T> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) -> CorrectedArm<N> {
        let Some(filter) = &config.bias_filter else { return CorrectedArm::UNKNOWN };
        let dt = since(self.last_us.unwrap_or(sensed.time_us), sensed.time_us);
        self.last_us = Some(sensed.time_us);
        let mut angles = sensed.bend.map(|bend| bend.sensors.map(|theta| theta.map(converted)));
        for (track, angles) in self.segments.iter_mut().zip(&mut angles) {
            *angles = track.monitor.corrected(*angles);
            track.take_bend(*angles, sensed.time_us);
        }
        if !self.is_started && !self.tare(config, filter, sensed) {
            // Until the IMUs are tared, the bend sensors alone.
            let fused = sensed.bend.map(|bend| bend.mean.map(S::to_turns));
            return CorrectedArm { fused, ..CorrectedArm::UNKNOWN };
        }
        self.track_headings(config, sensed);
        self.fill_absent_headings(config.segments.len(), dt);
        let corrected = self.angles(config.segments);
        self.state.trace_mut().record(BiasOperation::Output);
        if sensed.share == Share::Update {
            self.take_update(config.segments, sensed);
        } else {
            if sensed.share == Share::Prediction {
                self.take_prediction(config.segments, filter, sensed.time_us);
            }
            for _ in 0..turns(config) {
                if !self.take_turn(config.segments, filter, sensed, &angles) {
                    break;
                }
            }
        }
        if sensed.share == Share::Whole {
            self.follow_rest(sensed.time_us);
        }
        for track in &mut self.segments {
            track.last_bend = track.bend.map(|bend| bend.theta).or(track.last_bend);
        }
        corrected
    }
}

/// Number of segments processed in one sample: each segment at least ten times a second.
fn turns<S>(config: &ArmConfig<S>) -> u32 {
    let (count, rate_millihertz) = (config.segments.len() as u32, config.anchor.sample_rate_millihertz.max(1));
    (10_000 * count).div_ceil(rate_millihertz).min(count)
}

/// Converts an angle to another number type.
fn converted<S: Scalar, F: Scalar>(theta: S) -> F {
    F::from_q(theta.to_q())
}

/// Time from `from_us` to `to_us`, time units.
fn since<F: Scalar>(from_us: u64, to_us: u64) -> F {
    F::from_micros(to_us.saturating_sub(from_us).min(u64::from(u32::MAX)) as u32)
}

/// `a / b`, at most [`MAX_RATIO`].
fn bounded_ratio<F: Scalar>(a: F, b: F) -> F {
    let largest = F::from_int(MAX_RATIO);
    if b > a / largest { a / b } else { largest }
}
