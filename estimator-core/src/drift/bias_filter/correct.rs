//! The stages of the bias filter for one sample.

use crate::config::ArmConfig;
use crate::drift::bias_filter::filter::BiasFilter;
use crate::drift::bias_filter::track::since;
use crate::drift::bias_trace::{BiasOperation, BiasTrace};
use crate::drift::correction::{CorrectedArm, DriftCorrection, SensedArm};
use crate::drift::share::Share;
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::Scalar;

impl<S: Scalar, F: FusedOps, const N: usize, T: BiasTrace<F>> DriftCorrection<S, N> for BiasFilter<F, N, T> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) -> CorrectedArm<N> {
        let Some(filter) = &config.bias_filter else { return CorrectedArm::UNKNOWN };
        let dt = since(self.last_us.unwrap_or(sensed.time_us), sensed.time_us);
        self.last_us = Some(sensed.time_us);
        let mut angles = sensed.bend.map(|bend| bend.sensors.map(|theta| theta.map(converted)));
        for (track, angles) in self.segments.iter_mut().zip(&mut angles) {
            *angles = track.monitor.corrected(*angles);
            track.update_bend(*angles, sensed.time_us);
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
            self.update_next(config.segments, sensed);
        } else {
            if sensed.share == Share::Prediction {
                self.predict_next(config.segments, filter, sensed.time_us);
            }
            for _ in 0..segments_per_sample(config) {
                if !self.process_segment(config.segments, filter, sensed, &angles) {
                    break;
                }
            }
        }
        if sensed.share == Share::Whole {
            self.evaluate_rest(sensed.time_us);
        }
        for track in &mut self.segments {
            track.last_bend = track.bend.map(|bend| bend.theta).or(track.last_bend);
        }
        corrected
    }
}

/// Number of segments processed in one sample: each segment at least ten times a second.
fn segments_per_sample<S>(config: &ArmConfig<S>) -> u32 {
    let (count, rate_millihertz) = (config.segments.len() as u32, config.anchor.sample_rate_millihertz.max(1));
    (10_000 * count).div_ceil(rate_millihertz).min(count)
}

/// Converts an angle to another number type.
fn converted<S: Scalar, F: Scalar>(theta: S) -> F {
    F::from_q(theta.to_q())
}
