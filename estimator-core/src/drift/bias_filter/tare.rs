//! Start of the bias filter: prior, use of the bend sensors and plausibility of the tare.

use crate::config::{ArmConfig, BiasFilterConfig, SegmentConfig};
use crate::drift::bias_filter::filter::{BiasFilter, following, segments_per_sample};
use crate::drift::bias_filter::tare_statistics::reference_angle;
use crate::drift::bias_trace::BiasTrace;
use crate::drift::correction::SensedArm;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::variance_deg;

/// Largest mean square of the bend sensors' deviation from the reference pose in a good tare.
const BENT: Constant = variance_deg(6.0);
/// Prior of the straightness for a bad tare.
const BAD_TARE: Constant = variance_deg(12.0);

/// Weight of the offsets' prior variance, as a number of segments with a measured offset.
const PRIOR_SEGMENTS: i32 = 2;

impl<F: Scalar, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// Adds a sample to the tare, and starts the filter at its end; returns `false` until then.
    pub(super) fn tare<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
    ) -> bool {
        self.compare_with_reference(config, sensed);
        self.tare.add(sensed, &self.segments);
        if self.tare.samples < config.tare_samples {
            return false;
        }
        let is_tared = config.tare_samples > 0;
        self.start_tracks(config, filter, sensed);
        if is_tared {
            self.validate(config.segments);
        }
        let straightness = if self.is_tare_bad { F::constant(BAD_TARE) } else { F::from_q(filter.straightness) };
        let straightness = if is_tared { straightness } else { F::zero() };
        let offsets = self.segments.map(|track| track.offset_prior);
        self.state.initialise(filter, straightness, &offsets, sensed.time_us);
        if is_tared {
            self.keep_bend_of_tare(config.segments);
        }
        self.correct_tracks(sensed.time_us);
        (self.is_started, self.next_segment) = (true, 0);
        true
    }

    /// Compares the bend sensors of the next segments with their angle in the reference pose, which the arm has in a
    /// tare: of twins that are too far apart, the one that is further from it is left out from the next sample on.
    fn compare_with_reference<S: Scalar>(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) {
        if config.tare_samples == 0 {
            return;
        }
        for _ in 0..segments_per_sample(config) {
            let i = self.next_segment;
            self.next_segment = following(i, config.segments);
            let (Some(segment), Some(bend)) = (config.segments.get(i), sensed.bend.get(i)) else { return };
            let Some(track) = self.segments.get_mut(i) else { return };
            let reference = reference_angle(config.segments, i);
            let angles = track.sensor_angles(bend);
            track.monitor.check(&segment.bend_error, angles, reference, sensed.time_us);
        }
    }

    /// Checks the plausibility of the tare. If it is good, the variance of the offsets in this session is estimated
    /// from the bend sensors' readings of the straight arm.
    fn validate<S: Scalar>(&mut self, segments: &[SegmentConfig<S>]) {
        let spread = self.tare.bend_variance(segments);
        self.is_tare_bad = self.tare.has_moved() || spread > F::constant(BENT);
        if !self.is_tare_bad {
            let count = F::from_int(self.tare.segments.iter().filter(|tare| tare.bend_count > 0).count() as i32);
            let (own, all) = (F::from_int(PRIOR_SEGMENTS), F::from_int(PRIOR_SEGMENTS) + count);
            for track in &mut self.segments {
                let shown = track.session_offset * (own / all) + spread * (count / all);
                track.offset_prior += shown - track.session_offset;
                track.session_offset = shown;
            }
        }
    }

    /// Initialises the headings at the end of the tare, and the offsets' priors.
    fn start_tracks<S: Scalar>(&mut self, config: &ArmConfig<S>, filter: &BiasFilterConfig, sensed: &SensedArm<S, N>) {
        let mut below = Turns::ZERO;
        let headings = sensed.headings.iter().zip(config.segments);
        for ((track, tare), (heading, segment)) in self.segments.iter_mut().zip(&self.tare.segments).zip(headings) {
            (track.heading_measured_at_us, track.theta_measured_at_us) = (sensed.time_us, sensed.time_us);
            track.session_offset = F::from_q(filter.offset);
            track.offset_prior = track.session_offset;
            track.sensors = segment.bend.iter().flatten().count();
            track.last_bend = track.bend.map(|bend| bend.theta);
            track.motion = F::zero();
            let is_tared = config.tare_samples > 0;
            let in_world = heading.in_world().filter(|_| is_tared || heading.is_read());
            // An IMU that restarted during the tare: the newest reading is its zero, not the mean.
            let in_world = if tare.has_stepped { Some(segment.reference) } else { in_world };
            if tare.has_stepped {
                track.restarted_at_us = Some(sensed.time_us);
            }
            if let Some(in_world) = in_world {
                track.gate.tare(heading.unwrapped(), in_world, sensed.time_us);
                (track.heading, track.heading_read_at_us) = (in_world, sensed.time_us);
            } else if is_tared {
                track.heading = segment.reference;
            } else {
                track.gate.expect_absolute();
                track.heading = below + track.last_bend.unwrap_or_else(F::zero).to_turns();
            }
            below = track.heading;
        }
    }

    /// Stores the bend sensors' mean over the tare, by which the first update of each segment is made.
    fn keep_bend_of_tare<S: Scalar>(&mut self, segments: &[SegmentConfig<S>]) {
        let tracks = self.segments.iter_mut().zip(&self.tare.segments).take(segments.len());
        for (i, (track, tare)) in tracks.enumerate() {
            track.tare_bend = tare.bend_mean().map(|bend| bend - reference_angle(segments, i));
        }
    }

    /// Corrects θ of all segments by the biases of the tare.
    fn correct_tracks(&mut self, time_us: u64) {
        let mut below = Turns::ZERO;
        for (track, bias) in self.segments.iter_mut().zip(self.state.bias) {
            track.heading = track.heading - bias;
            track.theta = F::from_phase((track.heading - below).phase());
            below = track.heading;
            (track.counted_theta, track.processed_theta) = (track.theta, track.theta);
            track.counted_bend = track.last_bend.unwrap_or_else(F::zero);
            track.updated_at_us = time_us;
        }
    }
}
