//! The bias filter: drift correction by a Kalman filter over all headings, with bend sensors that may be wrong.
//!
//! A line of stages: trusted bend angles, plausible headings, absent headings from their neighbours, then one segment's update
//! of the [model](state) in each sample, and the rules for rest. Every rule counts in time, not in samples.
//!
//! The bend sensors' error depends on the way that they came (map, hysteresis), and is not white in time: they inform the
//! filter by travel, so that an arm at rest teaches nothing.

mod bend_monitor;
mod heading_gate;
mod headings;
mod rest;
pub mod state;
mod tare;
mod update;

use crate::config::{ArmConfig, BendErrorConfig, SENSORS_PER_SEGMENT};
use crate::drift::{CorrectedArm, DriftCorrection, SensedArm};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{smaller, variance_deg};
use crate::types::Condition;
use bend_monitor::{BendMonitor, TrustedBend};
use heading_gate::HeadingGate;
use rest::RestDetector;
use state::{BiasState, OFFSET};
use tare::TareStatistics;

/// A restart of an IMU and a step of a bend sensor are reported for so long.
const RECENT_US: u64 = 60_000_000;
/// Doubt about the offset of a segment whose sensor has stepped.
const STEPPED: Constant = variance_deg(1.0);
/// An absent heading's own error: 0.5° after a second, growing with the root of time.
const ABSENT: Constant = variance_deg(0.5 * 8.0);

/// State of the bias filter for up to `N` segments, in its number `F`.
///
/// ```
/// use estimator_core::{ArmConfig, BiasFilterConfig, Estimator, ImuReading, Phase, Q, Sample, SegmentConfig};
///
/// let segments = [SegmentConfig::<Q>::uncalibrated(0.080, 0.017)];
/// let config = ArmConfig { bias_filter: Some(BiasFilterConfig::BNO055), ..ArmConfig::uncalibrated(&segments) };
/// let mut estimator = Estimator::<Q, 1, 100>::new(&config)?;
/// let mut sample = Sample::missing(0);
/// sample.imu[0] = Some(ImuReading::Heading(Phase::from_degrees(30.0)));
/// let theta = estimator.update(&sample)[0].theta.expect("the IMU was read");
/// assert!((theta.rad().to_degrees() - 30.0).abs() < 0.1);
/// # Ok::<(), estimator_core::ConfigError>(())
/// ```
#[derive(Debug, Clone)]
pub struct BiasFilter<F, const N: usize> {
    state: BiasState<F, N>,
    tare: TareStatistics<F, N>,
    gates: [HeadingGate<F>; N],
    monitors: [BendMonitor<F>; N],
    segments: [SegmentTrack<F>; N],
    rest: RestDetector<F, N>,
    is_started: bool,
    is_tare_bad: bool,
    last_us: Option<u64>,
    /// The segment whose turn it is.
    turn: usize,
}

/// Per-segment state.
#[derive(Debug, Clone, Copy)]
struct SegmentTrack<F> {
    /// Heading of the segment's end in {W}.
    heading: Turns,
    /// θ of the last sample, rad.
    theta: F,
    /// θ_bend of the last sample that had one, rad.
    bend: Option<F>,
    is_heading_read: bool,
    heading_read_at_us: u64,
    /// θ and θ_bend of the last update.
    updated_theta: F,
    updated_bend: F,
    updated_at_us: u64,
    gated_since_us: Option<u64>,
    restarted_at_us: Option<u64>,
    stepped_at_us: Option<u64>,
    /// Variance of the offset's prior, so², and the part of it that lost sensors have added.
    offset_prior: F,
    lost: F,
    /// Whether one sensor of two is missing.
    is_single: bool,
}

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// At the start of a session.
    pub fn new() -> Self {
        let zero = F::zero();
        let track = SegmentTrack {
            heading: Turns::ZERO,
            theta: zero,
            bend: None,
            is_heading_read: false,
            heading_read_at_us: 0,
            updated_theta: zero,
            updated_bend: zero,
            updated_at_us: 0,
            gated_since_us: None,
            restarted_at_us: None,
            stepped_at_us: None,
            offset_prior: zero,
            lost: zero,
            is_single: false,
        };
        Self {
            state: BiasState::new(),
            tare: TareStatistics::new(zero),
            gates: [HeadingGate::new(zero); N],
            monitors: [BendMonitor::new(zero); N],
            segments: [track; N],
            rest: RestDetector::new(),
            is_started: false,
            is_tare_bad: false,
            last_us: None,
            turn: 0,
        }
    }

    /// Covariance of two headings, [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times rad².
    pub fn heading_covariance(&self, i: usize, j: usize) -> F {
        self.state.bias_covariance(i, j)
    }

    /// Variance of heading `i` beside the biases: of one that is absent, what its bend sensors may be off by.
    pub fn absence_variance(&self, config: &BendErrorConfig, i: usize) -> F {
        let track = &self.segments[i];
        if track.is_heading_read {
            return F::zero();
        }
        let absent_us =
            self.last_us.unwrap_or_default().saturating_sub(track.heading_read_at_us).min(u64::from(u32::MAX)) as u32;
        let grown = smaller(F::from_micros(absent_us), F::one()) * F::constant(ABSENT);
        smaller(grown, track.offset_prior + F::from_q(config.mean))
    }

    /// Condition of segment `i`.
    pub fn condition(&self, i: usize) -> Condition {
        let now_us = self.last_us.unwrap_or_default();
        let is_recent = |at_us: Option<u64>| at_us.is_some_and(|at_us| now_us.saturating_sub(at_us) < RECENT_US);
        let (Some(track), Some(monitor)) = (self.segments.get(i), self.monitors.get(i)) else {
            return Condition::default();
        };
        Condition {
            tare_bad: self.is_tare_bad,
            imu_absent: self.is_started && !track.is_heading_read,
            imu_restarted: is_recent(track.restarted_at_us),
            bend_distrusted: monitor.is_distrusted(now_us) || track.is_single || is_recent(track.stepped_at_us),
            gated: track.gated_since_us.is_some(),
        }
    }
}

impl<S: Scalar, F: Scalar, const N: usize> DriftCorrection<S, N> for BiasFilter<F, N> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) -> CorrectedArm<N> {
        let Some(filter) = &config.bias_filter else { return CorrectedArm::UNKNOWN };
        let elapsed_us = self.last_us.map_or(0, |last_us| sensed.time_us.saturating_sub(last_us));
        let dt = F::from_micros(elapsed_us.min(u64::from(u32::MAX)) as u32);
        self.last_us = Some(sensed.time_us);
        let angles = self.trust_bend(sensed, dt);
        let mut bend = self.bend_means(&angles, sensed.time_us);
        if !self.is_started && !self.tare(config, filter, sensed, &bend) {
            return CorrectedArm::UNKNOWN;
        }
        let last = self.segments.map(|track| track.theta);
        self.track_headings(config, sensed, &bend, dt);
        self.fill_absent_headings(config, &bend, dt);
        let corrected = self.angles(config.segments);
        self.check_bend(config, sensed, &corrected, &angles, (&last, elapsed_us));
        // Without the sensors that have just stepped.
        bend = self.bend_means(&angles, sensed.time_us);
        self.update_turn(config, filter, sensed, &bend);
        self.follow_rest(config, sensed, &bend, dt);
        for (track, bend) in self.segments.iter_mut().zip(&bend) {
            track.bend = bend.map(|bend| bend.theta).or(track.bend);
        }
        corrected
    }
}

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// Angles of the bend sensors in the filter's number, compared with each other.
    fn trust_bend<S: Scalar>(&mut self, sensed: &SensedArm<S, N>, dt: F) -> [[Option<F>; SENSORS_PER_SEGMENT]; N] {
        let mut angles = sensed.bend.map(|bend| bend.sensors.map(|theta| theta.map(converted)));
        for (angles, monitor) in angles.iter_mut().zip(&mut self.monitors) {
            *angles = monitor.corrected(*angles);
            monitor.compare(*angles, dt, sensed.time_us);
        }
        angles
    }

    fn bend_means(&self, angles: &[[Option<F>; SENSORS_PER_SEGMENT]; N], time_us: u64) -> [Option<TrustedBend<F>>; N] {
        let mut means = [None; N];
        for ((mean, monitor), angles) in means.iter_mut().zip(&self.monitors).zip(angles) {
            *mean = monitor.mean(*angles, time_us);
        }
        means
    }

    /// Holds the bend sensors against the IMUs: steps, departures, sensors that are stuck.
    fn check_bend<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        corrected: &CorrectedArm<N>,
        angles: &[[Option<F>; SENSORS_PER_SEGMENT]; N],
        (last, elapsed_us): (&[F; N], u64),
    ) {
        let tracks = self.segments.iter().zip(&self.state.offset).zip(last);
        let sensors = self.monitors.iter_mut().zip(angles).zip(&corrected.imu);
        let mut stepped = [false; N];
        for ((((monitor, angles), imu), ((track, offset), last)), (segment, stepped)) in
            sensors.zip(tracks).zip(config.segments.iter().zip(&mut stepped))
        {
            let motion = imu.map(|_| track.theta - *last);
            *stepped = monitor.find_steps(*angles, motion, elapsed_us, sensed.time_us);
            if imu.is_some() {
                monitor.check(&segment.bend_error, *angles, track.theta + *offset, sensed.time_us);
            }
        }
        for (i, _) in stepped.iter().enumerate().filter(|(_, stepped)| **stepped) {
            self.state.doubt(i, OFFSET, F::constant(STEPPED));
            self.segments[i].stepped_at_us = Some(sensed.time_us);
        }
    }
}

/// An angle in another number.
fn converted<S: Scalar, F: Scalar>(theta: S) -> F {
    F::from_phase(theta.to_turns().phase())
}

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// β_i − β_{i−1}, rad.
    fn angle_bias(&self, i: usize) -> F {
        let below = i.checked_sub(1).map_or(Turns::ZERO, |below| self.state.bias[below]);
        F::from_phase((self.state.bias[i] - below).phase())
    }
}
