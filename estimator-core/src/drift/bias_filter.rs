//! The bias filter: drift correction by a Kalman filter over all headings, with bend sensors that may be wrong.
//!
//! A line of stages: trusted bend angles, plausible headings, absent headings from their neighbours, then one segment's update
//! of the [model](super::bias_state) in each sample, and the rules for rest. Every rule counts in time, not in samples.
//!
//! The bend sensors' error depends on the way that they came (map, hysteresis), and is not white in time: they inform the
//! filter by travel, so that an arm at rest teaches nothing.

use crate::config::{ArmConfig, BendErrorConfig, BiasFilterConfig, SENSORS_PER_SEGMENT, SegmentConfig};
use crate::drift::bend_monitor::{BendMonitor, TrustedBend};
use crate::drift::bias_state::{BIAS, BiasState, OFFSET, RATE};
use crate::drift::heading_gate::{Expected, HeadingGate, Verdict};
use crate::drift::rest::{RestDetector, RestWindow};
use crate::drift::{CorrectedArm, DriftCorrection, SensedArm};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, is_beyond, larger, magnitude, scaled_square, smaller, variance_deg};

/// Travel of the IMUs and of the bend sensors since the last update, below which there is no new information.
const IMU_TRAVEL: Constant = degrees(1.0);
const BEND_TRAVEL: Constant = degrees(0.5);
/// Factor on the measurement noise: errors that last longer than ℓ and τ.
const LONG_ERRORS: i32 = 2;
/// Largest factor on the measurement noise: the update is worth nothing beyond it.
const MAX_RATIO: i32 = 15;
/// Standard deviation of the bend sensors' scale error: 5 % of the bend angle.
const SCALE_ERROR: Constant = Constant::new(0.05);
/// Innovation gate in predicted standard deviations.
const GATE: Constant = Constant::new(6.0);
/// After so long beyond the gate the bias and the offset become doubtful, by 3°.
const GATE_TIMEOUT_US: u64 = 30_000_000;
const GATED: Constant = variance_deg(3.0);
/// A tare is bad where headings spread by more than this, or the bend sensors' root mean square is this far off the reference
/// pose; its straightness is the last one.
const STILL: Constant = degrees(1.5);
const BENT: Constant = variance_deg(10.0);
const BAD_TARE: Constant = variance_deg(12.0);
/// Doubt about a new zero that no bend sensor supports.
const UNSEEN_ZERO: Constant = variance_deg(15.0);
/// Doubt about the offset of a segment whose sensor has stepped.
const STEPPED: Constant = variance_deg(1.0);
/// Growth of the offset's variance where one sensor of two is lost, in slow variances of their difference.
const LOST_SENSOR: Constant = Constant::new(1.5);
/// Doubt about a new zero: 2°, a quarter of the bend sensors' variance, and 0.02° a second of absence up to 400 s.
const NEW_ZERO: Constant = variance_deg(2.0);
const NEW_ZERO_CREEP: Constant = variance_deg(0.02 * 8.0);
const NEW_ZERO_RATE: Constant = variance_deg(0.025 * TIME_UNIT_S);
/// Doubt about an IMU that returned near its old zero.
const RETURNED: Constant = variance_deg(1.0);
/// An absent heading is drawn to its bend sensors with this time constant, time units: 20 s.
const ABSENT_TIME: Constant = Constant::new(20.0 / TIME_UNIT_S);
/// An absent heading's own error: 0.5° after a second, growing with the root of time.
const ABSENT: Constant = variance_deg(0.5 * 8.0);
/// Bend sensors do not move by more in one sample: a step of a sensor, not of the arm.
const BEND_STEP: Constant = degrees(12.0);
/// Doubt about the heading of a resting arm, 0.02 °/√s, and about the rate learned at rest.
const REST_CREEP: Constant = variance_deg(0.02 * 8.0);
const REST_READING: Constant = variance_deg(0.064);
/// Gate of a rest's heading change, in predicted standard deviations.
const REST_GATE: Constant = Constant::new(3.0);
/// An IMU whose bend sensors move by this much, and by four of their standard deviations, must change.
const FROZEN_MOTION: Constant = degrees(8.0);
const FROZEN_DEVIATIONS: Constant = Constant::new(4.0);

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
    last_us: u64,
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
    /// Variance of the offset's prior, so², and the part of it that lost sensors have added.
    offset_prior: F,
    lost: F,
    /// Whether one sensor of two is missing.
    is_single: bool,
}

/// Sums of the tare.
#[derive(Debug, Clone, Copy)]
struct TareStatistics<F, const N: usize> {
    samples: u32,
    first: [Option<Turns>; N],
    range: [[F; 2]; N],
    bend_sum: [Turns; N],
    bend_count: [u16; N],
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
            offset_prior: zero,
            lost: zero,
            is_single: false,
        };
        let tare = TareStatistics {
            samples: 0,
            first: [None; N],
            range: [[zero; 2]; N],
            bend_sum: [Turns::ZERO; N],
            bend_count: [0; N],
        };
        Self {
            state: BiasState::new(),
            tare,
            gates: [HeadingGate::new(zero); N],
            monitors: [BendMonitor::new(zero); N],
            segments: [track; N],
            rest: RestDetector::new(),
            is_started: false,
            is_tare_bad: false,
            last_us: 0,
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
        let absent_us = self.last_us.saturating_sub(track.heading_read_at_us).min(u64::from(u32::MAX)) as u32;
        let grown = smaller(F::from_micros(absent_us), F::one()) * F::constant(ABSENT);
        smaller(grown, track.offset_prior + F::from_q(config.mean))
    }

    /// Whether the tare was bent or moving, so that the bend sensors set the biases.
    pub fn is_tare_bad(&self) -> bool {
        self.is_tare_bad
    }
}

impl<S: Scalar, F: Scalar, const N: usize> DriftCorrection<S, N> for BiasFilter<F, N> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) -> CorrectedArm<N> {
        let Some(filter) = &config.bias_filter else { return CorrectedArm::UNKNOWN };
        let elapsed_us = sensed.time_us.saturating_sub(self.last_us);
        let dt = F::from_micros(elapsed_us.min(u64::from(u32::MAX)) as u32);
        self.last_us = sensed.time_us;
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
        }
    }
}

/// An angle in another number.
fn converted<S: Scalar, F: Scalar>(theta: S) -> F {
    F::from_phase(theta.to_turns().phase())
}

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// Gathers the tare, and starts at its end; `false` until then.
    fn tare<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
    ) -> bool {
        self.tare.add(sensed, bend);
        if self.tare.samples < config.tare_samples {
            return false;
        }
        self.start(config, filter, sensed, bend);
        true
    }

    /// The prior at the end of the tare, and what the bend sensors read in it.
    fn start<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
    ) {
        let time_us = sensed.time_us;
        let is_tared = config.tare_samples > 0;
        let mut below = Turns::ZERO;
        for (i, segment) in config.segments.iter().enumerate().take(N) {
            let excess = self.monitors[i].offset_excess(&segment.bend_error, true);
            let track = &mut self.segments[i];
            track.offset_prior = F::from_q(filter.offset) + excess;
            track.bend = bend[i].map(|bend| bend.theta);
            let heading = &sensed.headings[i];
            if let Some(in_world) = heading.in_world() {
                self.gates[i].tare(heading.unwrapped(), in_world, time_us);
                (track.heading, track.heading_read_at_us) = (in_world, time_us);
            } else {
                track.heading = if is_tared { segment.reference } else { below };
            }
            below = track.heading;
        }
        let spread = self.tare.bend_variance(config.segments);
        self.is_tare_bad = is_tared && (self.tare.moved() || spread > F::constant(BENT));
        if is_tared && !self.is_tare_bad {
            // What the bend sensors read of a straight arm is the size of their offsets in this session.
            for track in &mut self.segments {
                track.offset_prior = larger(track.offset_prior, spread);
            }
        }
        let straightness = if self.is_tare_bad { F::constant(BAD_TARE) } else { F::from_q(filter.straightness) };
        let straightness = if is_tared { straightness } else { F::zero() };
        self.state.initialise(filter, straightness, &self.segments.map(|track| track.offset_prior), time_us);
        if is_tared {
            self.use_bend_of_tare(config.segments);
        }
        let mut below = Turns::ZERO;
        for (track, bias) in self.segments.iter_mut().zip(self.state.bias) {
            track.heading = track.heading - bias;
            track.theta = F::from_phase((track.heading - below).phase());
            below = track.heading;
            track.updated_theta = track.theta;
            track.updated_bend = track.bend.unwrap_or_else(F::zero);
            track.updated_at_us = time_us;
        }
        self.is_started = true;
    }

    /// One update by the bend sensors' mean over the tare: the reference pose is known to its straightness alone.
    fn use_bend_of_tare<S: Scalar>(&mut self, segments: &[SegmentConfig<S>]) {
        let mut below = Turns::ZERO;
        for (i, segment) in segments.iter().enumerate().take(N) {
            let reference: F = F::from_phase((segment.reference - below).phase());
            below = segment.reference;
            let Some(bend) = self.tare.bend_mean(i) else { continue };
            let bias = self.angle_bias(i);
            let nu = reference - bend - bias + self.state.offset[i];
            let innovation = self.state.innovation(i);
            self.state.update(&innovation, nu, F::from_q(segment.bend_error.mean));
        }
    }

    /// β_i − β_{i−1}, rad.
    fn angle_bias(&self, i: usize) -> F {
        let below = i.checked_sub(1).map_or(Turns::ZERO, |below| self.state.bias[below]);
        F::from_phase((self.state.bias[i] - below).phase())
    }

    /// Headings that are read and plausible, from the base to the tip.
    fn track_headings<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
        dt: F,
    ) {
        let mut below = Turns::ZERO;
        for (i, segment) in config.segments.iter().enumerate().take(N) {
            let motion = self.motion(i, bend, dt);
            let track = self.segments[i];
            let deviations = F::constant(FROZEN_MOTION);
            let frozen_motion = if is_beyond(deviations, FROZEN_DEVIATIONS, F::from_q(segment.bend_error.mean)) {
                deviations
            } else {
                deviations + deviations
            };
            let expected = Expected {
                heading: below + (track.theta + motion).to_turns(),
                motion,
                bias: self.state.bias[i],
                theta: track.theta,
                bend: bend[i].map(|bend| bend.theta),
                frozen_motion,
            };
            let heading = &sensed.headings[i];
            let reading = heading.is_read().then(|| heading.unwrapped());
            let verdict = self.gates[i].take(reading, segment.imu_scale_error, &expected, sensed.time_us);
            self.apply(i, verdict, &expected, &segment.bend_error, sensed.time_us);
            below = self.segments[i].heading;
        }
    }

    /// Motion of segment `i`'s bend sensors since the last sample.
    fn motion(&self, i: usize, bend: &[Option<TrustedBend<F>>; N], dt: F) -> F {
        let motion = bend[i].zip(self.segments[i].bend).map_or(F::zero(), |(now, last)| now.theta - last);
        let is_step = magnitude(motion) > F::constant(BEND_STEP) && dt < F::from_micros(1_000_000);
        if is_step { F::zero() } else { motion }
    }

    /// Uses a heading, and doubts its bias where it may have a new zero.
    fn apply(&mut self, i: usize, verdict: Verdict<F>, expected: &Expected<F>, error: &BendErrorConfig, time_us: u64) {
        let mut heading = expected.heading;
        let mut is_read = true;
        match verdict {
            Verdict::Accepted(read) => heading = read,
            Verdict::Returned(read, _) => {
                heading = read;
                self.state.doubt(i, BIAS, F::constant(RETURNED));
            }
            Verdict::Restarted(deviation, absence_us) => {
                self.state.bias[i] = self.state.bias[i] + deviation;
                let absence = F::from_micros(absence_us.min(400_000_000) as u32);
                let quarter = F::from_q(error.mean).half().half();
                let seen = F::constant(NEW_ZERO) + quarter + absence * F::constant(NEW_ZERO_CREEP);
                let doubt = if expected.bend.is_some() { seen } else { F::constant(UNSEEN_ZERO) };
                self.state.doubt(i, BIAS, doubt);
                self.state.doubt(i, RATE, F::constant(NEW_ZERO_RATE));
            }
            Verdict::Frozen(theta) => {
                let change = theta - expected.theta;
                heading = heading + (change - expected.motion).to_turns();
                is_read = false;
                if let Some(above) = self.segments.get_mut(i + 1) {
                    above.theta -= change - expected.motion;
                }
            }
            Verdict::Absent => is_read = false,
        }
        let track = &mut self.segments[i];
        (track.heading, track.is_heading_read) = (heading, is_read);
        if is_read {
            track.heading_read_at_us = time_us;
        }
    }

    /// Headings that were not read: from below by the segment's own bend sensors, and from above by those of the next.
    fn fill_absent_headings<S: Scalar>(&mut self, config: &ArmConfig<S>, bend: &[Option<TrustedBend<F>>; N], dt: F) {
        let mut below = Turns::ZERO;
        for i in 0..N.min(config.segments.len()) {
            if !self.segments[i].is_heading_read {
                let share = smaller(dt / F::constant(ABSENT_TIME), F::one());
                let pull = bend[i].map_or(F::zero(), |bend| bend.theta - self.state.offset[i] - self.segments[i].theta);
                let own = self.segments[i].theta + self.motion(i, bend, dt) + share * pull;
                let mut heading = below + own.to_turns();
                if let Some(above) = self.segments.get(i + 1).filter(|above| above.is_heading_read) {
                    let next = above.theta + self.motion(i + 1, bend, dt);
                    let from_above = above.heading - next.to_turns();
                    let half: F = F::from_phase((from_above - heading).phase()).half();
                    heading = heading + half.to_turns();
                }
                self.segments[i].heading = heading;
            }
            below = self.segments[i].heading;
        }
    }

    /// θ of all segments, from their headings.
    fn angles<S>(&mut self, segments: &[SegmentConfig<S>]) -> CorrectedArm<N> {
        let mut corrected = CorrectedArm::UNKNOWN;
        let (mut below, mut is_below_read) = (Turns::ZERO, true);
        for (i, track) in self.segments.iter_mut().enumerate().take(segments.len()) {
            let theta = Turns::from((track.heading - below).phase());
            track.theta = F::from_phase(theta.phase());
            corrected.fused[i] = Some(theta);
            corrected.imu[i] = (track.is_heading_read && is_below_read).then_some(theta);
            (below, is_below_read) = (track.heading, track.is_heading_read);
        }
        corrected
    }

    /// Predicts the IMU and the segment whose turn it is, and updates the filter by its bend sensors.
    fn update_turn<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
    ) {
        let i = self.turn;
        self.turn = if i + 1 < config.segments.len().min(N) { i + 1 } else { 0 };
        let Some(segment) = config.segments.get(i) else { return };
        self.grow_offset(i, filter, &segment.bend_error, bend[i].as_ref());
        if self.rest.is_resting() {
            self.state.predict_at_rest(i, filter, F::constant(REST_CREEP), sensed.time_us);
        } else {
            self.state.predict(i, filter, self.segments[i].offset_prior, sensed.time_us);
        }
        let is_below_read = i.checked_sub(1).is_none_or(|below| self.segments[below].is_heading_read);
        let is_trusted = self.segments[i].is_heading_read && is_below_read && !sensed.bend[i].is_extrapolated;
        if let Some(bend) = bend[i].filter(|_| is_trusted) {
            self.update(i, &segment.bend_error, bend, sensed.time_us);
        }
    }

    /// Widens the prior of the offset where the two sensors disagree more than before, or one is lost.
    fn grow_offset(
        &mut self,
        i: usize,
        filter: &BiasFilterConfig,
        error: &BendErrorConfig,
        bend: Option<&TrustedBend<F>>,
    ) {
        let track = &mut self.segments[i];
        let is_single = bend.is_some_and(|bend| bend.is_single);
        if is_single && !track.is_single {
            track.lost += F::constant(LOST_SENSOR) * scaled_square(F::from_q(error.slow_difference));
        }
        track.is_single = is_single;
        let prior = F::from_q(filter.offset) + track.lost + self.monitors[i].offset_excess(error, false);
        if prior > track.offset_prior {
            self.state.doubt(i, OFFSET, prior - track.offset_prior);
            track.offset_prior = prior;
        }
    }

    /// Update of segment `i` by its bend sensors, if they have moved since the last one and pass the innovation gate.
    fn update(&mut self, i: usize, error: &BendErrorConfig, bend: TrustedBend<F>, time_us: u64) {
        let track = self.segments[i];
        let single = if bend.is_single { F::from_q(error.difference) } else { F::zero() };
        let sigma = F::from_q(error.mean) + single + scaled_square(F::constant(SCALE_ERROR) * track.theta);
        let nu = track.theta - bend.theta + self.state.offset[i];
        let innovation = self.state.innovation(i);
        if is_beyond(nu, GATE, innovation.variance + sigma) {
            self.reject(i, time_us);
            return;
        }
        self.segments[i].gated_since_us = None;
        let travel = magnitude(track.theta - track.updated_theta);
        let bend_travel = magnitude(bend.theta - track.updated_bend);
        if travel < F::constant(IMU_TRAVEL) || bend_travel < F::constant(BEND_TRAVEL) {
            return;
        }
        let elapsed_us = time_us.saturating_sub(track.updated_at_us).min(u64::from(u32::MAX)) as u32;
        let by_travel = bounded_ratio(F::from_q(error.travel), travel);
        let by_time = bounded_ratio(F::from_q(error.correlation_time).half(), F::from_micros(elapsed_us));
        let ratio =
            [by_travel, by_time].into_iter().fold(F::one(), |most, ratio| if ratio > most { ratio } else { most });
        self.state.update(&innovation, nu, F::from_int(LONG_ERRORS) * ratio * sigma);
        let track = &mut self.segments[i];
        (track.updated_theta, track.updated_bend, track.updated_at_us) = (track.theta, bend.theta, time_us);
    }

    /// An innovation beyond the gate: when none passes for long, the bias and the offset are doubted.
    fn reject(&mut self, i: usize, time_us: u64) {
        let since_us = *self.segments[i].gated_since_us.get_or_insert(time_us);
        if time_us.saturating_sub(since_us) >= GATE_TIMEOUT_US {
            self.state.doubt(i, BIAS, F::constant(GATED));
            self.state.doubt(i, OFFSET, F::constant(GATED));
            self.segments[i].gated_since_us = None;
        }
    }

    /// Learns the rates from an arm at rest, and holds its shape.
    fn follow_rest<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
        dt: F,
    ) {
        let mut headings = [None; N];
        let mut angles = [None; N];
        for (i, _) in config.segments.iter().enumerate().take(N) {
            let track = &self.segments[i];
            headings[i] = track.is_heading_read.then(|| track.heading + self.state.bias[i]);
            angles[i] = bend[i].map(|bend| bend.theta.to_turns());
        }
        let Some(window) = self.rest.take(&headings, &angles, dt, sensed.time_us) else { return };
        for j in 0..config.segments.len().min(N) {
            if let Some(change) = window.headings[j] {
                self.learn_rate(j, change, &window);
            }
        }
    }

    /// The change of heading `j` over a window of rest, H = (v_j: dt).
    fn learn_rate(&mut self, j: usize, change: F, window: &RestWindow<F, N>) {
        let dt = F::from_micros(window.length_us.min(u64::from(u32::MAX)) as u32);
        let drift = self.state.rate[j] * dt;
        let nu = change - drift;
        let r = F::constant(REST_READING) + scaled_square(window.bend[j]);
        let innovation = self.state.innovation_at_rest(j, dt);
        if is_beyond(nu, REST_GATE, innovation.variance + r) {
            return;
        }
        self.state.update(&innovation, nu, r);
        // The shape stays: what the heading has changed by was its bias.
        self.state.bias[j] = self.state.bias[j] + nu.to_turns();
    }
}

/// `a / b`, at most [`MAX_RATIO`].
fn bounded_ratio<F: Scalar>(a: F, b: F) -> F {
    let largest = F::from_int(MAX_RATIO);
    if b * largest > a { a / b } else { largest }
}

impl<F: Scalar, const N: usize> TareStatistics<F, N> {
    fn add<S: Scalar>(&mut self, sensed: &SensedArm<S, N>, bend: &[Option<TrustedBend<F>>; N]) {
        self.samples = self.samples.saturating_add(1);
        for (i, heading) in sensed.headings.iter().enumerate() {
            if heading.is_read() {
                let first = *self.first[i].get_or_insert(heading.unwrapped());
                let deviation: F = F::from_phase((heading.unwrapped() - first).phase());
                let [lowest, highest] = self.range[i];
                self.range[i] = [smaller(lowest, deviation), -smaller(-highest, -deviation)];
            }
            if let Some(bend) = bend[i].filter(|_| self.bend_count[i] < u16::MAX) {
                self.bend_sum[i] = self.bend_sum[i] + bend.theta.to_turns();
                self.bend_count[i] += 1;
            }
        }
    }

    fn bend_mean(&self, i: usize) -> Option<F> {
        (self.bend_count[i] > 0).then(|| F::from_phase(self.bend_sum[i].mean_of(self.bend_count[i]).phase()))
    }

    /// Whether the arm moved.
    fn moved(&self) -> bool {
        self.range.iter().any(|[lowest, highest]| *highest - *lowest > F::constant(STILL))
    }

    /// Mean square of the bend angles' distance from the reference pose, as variances are held.
    fn bend_variance<S: Scalar>(&self, segments: &[SegmentConfig<S>]) -> F {
        let (mut sum, mut count, mut below) = (F::zero(), 0, Turns::ZERO);
        for (i, segment) in segments.iter().enumerate() {
            let reference: F = F::from_phase((segment.reference - below).phase());
            below = segment.reference;
            let Some(bend) = self.bend_mean(i) else { continue };
            // In sixteenths, so that the sum fits.
            sum += scaled_square(bend - reference) / F::from_int(16);
            count += 1;
        }
        smaller(sum / F::from_int(count.max(1)), F::one()) * F::from_int(16)
    }
}
