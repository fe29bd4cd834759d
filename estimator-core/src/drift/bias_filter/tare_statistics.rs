//! Statistics of the tare.

use crate::config::SegmentConfig;
use crate::drift::bend_monitor::TrustedBend;
use crate::drift::bias_filter::track::SegmentTrack;
use crate::drift::correction::SensedArm;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{degrees, magnitude, scaled_square, smaller};

/// Largest spread of a heading in a good tare.
const STILL: Constant = degrees(1.5);
/// A heading has a new zero if it changes from one reading to the next by more than this plus twice the motion of the
/// bend sensors below.
const STEP: Constant = degrees(6.0);

/// Sums of the tare.
#[derive(Debug, Clone, Copy)]
pub(super) struct TareStatistics<F, const N: usize> {
    pub samples: u32,
    pub segments: [SegmentTare<F>; N],
}

/// Sums of one segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct SegmentTare<F> {
    /// First heading since the last step, and the range of all relative to it.
    pub first: Option<Turns>,
    pub range: [F; 2],
    pub newest: Option<Turns>,
    /// The IMU has restarted with another zero.
    pub has_stepped: bool,
    pub newest_bend: Option<F>,
    /// One sensor of two is missing.
    pub is_single: bool,
    pub bend_sum: Turns,
    pub bend_count: u16,
}

impl<F: Scalar> SegmentTare<F> {
    /// Adds a heading; the bend sensors up to this segment have moved by `moved` since the last sample.
    fn add_heading(&mut self, heading: Turns, moved: F) {
        let change = self.newest.replace(heading).map_or(F::zero(), |last| F::from_phase((heading - last).phase()));
        if magnitude(change) > F::constant(STEP) + moved + moved {
            (self.first, self.range, self.has_stepped) = (None, [F::zero(); 2], true);
        }
        let first = *self.first.get_or_insert(heading);
        let deviation: F = F::from_phase((heading - first).phase());
        let [lowest, highest] = self.range;
        self.range = [smaller(lowest, deviation), -smaller(-highest, -deviation)];
    }

    /// Adds a bend angle; returns the size of its change since the last one. The sums begin again where a sensor is left
    /// out or comes back.
    fn add_bend(&mut self, bend: TrustedBend<F>) -> F {
        let TrustedBend { theta, is_single } = bend;
        if is_single != self.is_single {
            (self.bend_sum, self.bend_count, self.newest_bend) = (Turns::ZERO, 0, None);
            self.is_single = is_single;
        }
        if self.bend_count < u16::MAX {
            self.bend_sum = self.bend_sum + theta.to_turns();
            self.bend_count += 1;
        }
        self.newest_bend.replace(theta).map_or(F::zero(), |last| magnitude(theta - last))
    }

    fn has_moved(&self) -> bool {
        let [lowest, highest] = self.range;
        highest - lowest > F::constant(STILL)
    }

    pub fn bend_mean(&self) -> Option<F> {
        (self.bend_count > 0).then(|| F::from_phase(self.bend_sum.mean_of(self.bend_count).phase()))
    }
}

impl<F: Scalar, const N: usize> TareStatistics<F, N> {
    pub const fn new(zero: F) -> Self {
        let segment = SegmentTare {
            first: None,
            range: [zero; 2],
            newest: None,
            has_stepped: false,
            newest_bend: None,
            is_single: false,
            bend_sum: Turns::ZERO,
            bend_count: 0,
        };
        Self { samples: 0, segments: [segment; N] }
    }

    pub fn add<S>(&mut self, sensed: &SensedArm<S, N>, tracks: &[SegmentTrack<F>; N]) {
        self.samples = self.samples.saturating_add(1);
        let mut moved = F::zero();
        for ((segment, heading), track) in self.segments.iter_mut().zip(&sensed.headings).zip(tracks) {
            moved += track.bend.map_or(F::zero(), |bend| segment.add_bend(bend));
            if heading.is_read() {
                segment.add_heading(heading.unwrapped(), moved);
            }
        }
    }

    pub fn has_moved(&self) -> bool {
        self.segments.iter().any(SegmentTare::has_moved)
    }

    /// Mean square of the bend angles' distance from the reference pose, as variances are held.
    pub fn bend_variance<S: Scalar>(&self, segments: &[SegmentConfig<S>]) -> F {
        let (mut sum, mut count) = (F::zero(), 0);
        for (i, tare) in self.segments.iter().enumerate().take(segments.len()) {
            let Some(bend) = tare.bend_mean() else { continue };
            // In sixteenths, so that the sum fits.
            sum += scaled_square(bend - reference_angle(segments, i)) / F::from_int(16);
            count += 1;
        }
        smaller(sum / F::from_int(count.max(1)), F::one()) * F::from_int(16)
    }
}

/// Bend angle of segment `i` in the reference pose, rad. Not inlined: only a tare needs it.
#[inline(never)]
pub(super) fn reference_angle<F: Scalar, S>(segments: &[SegmentConfig<S>], i: usize) -> F {
    let of = |i: usize| segments.get(i).map_or(Turns::ZERO, |segment| segment.reference);
    let below = i.checked_sub(1).map_or(Turns::ZERO, of);
    F::from_phase((of(i) - below).phase())
}
