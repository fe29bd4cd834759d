//! The tare: the prior of the bias filter, from headings and bend angles in the reference pose.

use super::BiasFilter;
use super::bend_monitor::TrustedBend;
use crate::config::{ArmConfig, BiasFilterConfig, SegmentConfig};
use crate::drift::SensedArm;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{degrees, larger, scaled_square, smaller, variance_deg};

/// A tare is bad where headings spread by more than this, or the bend sensors' root mean square is this far off the reference
/// pose; its straightness is the last one.
const STILL: Constant = degrees(1.5);
const BENT: Constant = variance_deg(10.0);
const BAD_TARE: Constant = variance_deg(12.0);

/// Factor on the bend sensors' variance in the tare: one pose, with hysteresis in it.
const TARE_NOISE: Constant = Constant::new(4.0);

/// Sums of the tare.
#[derive(Debug, Clone, Copy)]
pub(super) struct TareStatistics<F, const N: usize> {
    samples: u32,
    first: [Option<Turns>; N],
    range: [[F; 2]; N],
    bend_sum: [Turns; N],
    bend_count: [u16; N],
}

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// Gathers the tare, and starts at its end; `false` until then.
    pub(super) fn tare<S: Scalar>(
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
            // What the bend sensors read of a straight arm, beyond their scatter, is the size of their offsets in this session.
            let scatter = mean_variance(config.segments);
            let shown = smaller(larger(spread - scatter, F::zero()), F::constant(BENT));
            for track in &mut self.segments {
                track.offset_prior = larger(track.offset_prior, shown + shown);
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
            self.state.update(&innovation, nu, F::constant(TARE_NOISE) * F::from_q(segment.bend_error.mean));
        }
    }
}

impl<F: Scalar, const N: usize> TareStatistics<F, N> {
    pub(super) fn new(zero: F) -> Self {
        Self { samples: 0, first: [None; N], range: [[zero; 2]; N], bend_sum: [Turns::ZERO; N], bend_count: [0; N] }
    }

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

/// Mean of the bend sensors' variances over the segments that have any.
fn mean_variance<S: Scalar, F: Scalar>(segments: &[SegmentConfig<S>]) -> F {
    let with_sensors = || segments.iter().filter(|segment| segment.bend.iter().any(Option::is_some));
    let count = F::from_int(with_sensors().count().max(1) as i32);
    with_sensors().fold(F::zero(), |sum, segment| sum + F::from_q(segment.bend_error.mean) / count)
}
