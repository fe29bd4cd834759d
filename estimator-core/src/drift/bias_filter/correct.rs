//! The stages of the bias filter for one sample.

use crate::config::ArmConfig;
use crate::drift::bias_filter::filter::{BiasFilter, segments_per_sample};
use crate::drift::bias_filter::track::since;
use crate::drift::bias_trace::{BiasOperation, BiasTrace};
use crate::drift::correction::{CorrectedArm, DriftCorrection, SensedArm};
use crate::drift::share::Share;
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::Scalar;

impl<S: Scalar, F: FusedOps, const N: usize, T: BiasTrace<F>> DriftCorrection<S, N> for BiasFilter<F, N, T> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>, corrected: &mut CorrectedArm<N>) {
        let Some(filter) = &config.bias_filter else { return };
        let dt = since(self.last_us.unwrap_or(sensed.time_us), sensed.time_us);
        self.last_us = Some(sensed.time_us);
        for (track, bend) in self.segments.iter_mut().zip(&sensed.bend) {
            track.update_bend(track.sensor_angles(bend), sensed.time_us);
            track.is_outside = bend.is_outside;
        }
        if !self.is_started && !self.tare(config, filter, sensed) {
            // Until the IMUs are tared, the bend sensors alone.
            *corrected = CorrectedArm::UNKNOWN;
            for (fused, bend) in corrected.fused.iter_mut().zip(&sensed.bend) {
                *fused = bend.mean.map(S::to_turns);
            }
            return;
        }
        self.track_headings(config, sensed);
        self.fill_absent_headings(config.segments.len(), dt, sensed.time_us);
        self.angles(config.segments, sensed.time_us, corrected);
        self.state.trace_mut().record(BiasOperation::Output);
        if sensed.share == Share::Update {
            self.update_next(config.segments, sensed);
        } else {
            if sensed.share == Share::Prediction {
                self.predict_next(config.segments, filter, sensed.time_us);
            }
            for _ in 0..segments_per_sample(config) {
                if !self.process_segment(config.segments, filter, sensed) {
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
    }
}
