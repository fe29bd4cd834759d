//! Drift anchor: the moving average of the IMUs' bend angle less that of the bend sensors (paper, eq. 2 and 3).

use crate::config::{AnchorConfig, ArmConfig};
use crate::drift::correction::{CorrectedArm, DriftCorrection, MeasuredAngles, SensedArm};
use crate::drift::decimator::Decimated;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::Scalar;
use crate::sensing::heading::SegmentHeading;

/// Moving average over `window` values of θ_imu,i − θ_bend,i for one segment, of up to `W` values.
///
/// As both means of the paper run over the same samples, offset_i = MA(θ_imu,i) − MA(θ_bend,i) is one mean of the
/// differences. The sum is of integers, and therefore exact over any time. If a sample lacks one of the two angles, its
/// place in the window stays empty; while the whole window is empty, the newest offset holds.
///
/// ```
/// use estimator_core::{MovingAverageAnchor, AnchorConfig, Decimator, Turns};
///
/// let config = AnchorConfig {
///     window: 2,
///     rate_millihertz: 10_000,
///     sample_rate_millihertz: 10_000,
///     threshold: Turns::ZERO,
/// };
/// let (mut decimator, mut anchor) = (Decimator::new(), MovingAverageAnchor::<2>::new());
/// for value in [1, 3, 5] {
///     anchor.push(decimator.advance(&config), Some(Turns::from_bits(value)));
/// }
/// assert_eq!(anchor.offset(), Some(Turns::from_bits(4)));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MovingAverageAnchor<const W: usize> {
    offset: Option<Turns>,
    mean: Mean,
    group: Mean,
    /// The ring buffer of the window's values, and 1 for each value that is present; a missing value is zero.
    window: [Turns; W],
    counts: [u8; W],
}

/// A mean of up to 65 535 values.
#[derive(Debug, Clone, Copy)]
struct Mean {
    sum: Turns,
    count: i32,
}

impl Mean {
    const EMPTY: Self = Self { sum: Turns::ZERO, count: 0 };

    #[inline]
    fn value(self) -> Option<Turns> {
        (self.count != 0).then(|| self.sum.mean_of(self.count as u16))
    }
}

impl<const W: usize> MovingAverageAnchor<W> {
    /// An anchor before its first value.
    #[must_use]
    pub const fn new() -> Self {
        Self { offset: None, mean: Mean::EMPTY, group: Mean::EMPTY, window: [Turns::ZERO; W], counts: [0; W] }
    }

    /// Adds this sample's difference θ_imu,i − θ_bend,i, or `None` where one of the two is unknown.
    ///
    /// The cost is the same for samples that complete a value of the window and for those that do not.
    #[inline]
    pub fn push(&mut self, decimated: Decimated, difference: Option<Turns>) {
        self.take(difference.unwrap_or_default(), i32::from(difference.is_some()), decimated);
    }

    /// Updates the window. Not inlined, so that the loop over the segments leaves it all registers.
    #[inline(never)]
    fn take(&mut self, sum: Turns, count: i32, Decimated { oldest, complete }: Decimated) {
        let Self { offset, mean, group, window, counts } = self;
        let k = usize::from(oldest);
        let (Some(place), Some(counts)) = (window.get_mut(k), counts.get_mut(k)) else { return };
        let whole = Mean { sum: group.sum + sum, count: group.count + count };
        let newest = whole.value();
        // An incomplete value adds zero, by a mask instead of a branch, for constant cost.
        let more = (newest.unwrap_or_default() - *place).masked(complete);
        let more_counts = (i32::from(newest.is_some()) - i32::from(*counts)) & complete;
        *group = Mean { sum: whole.sum.masked(!complete), count: whole.count & !complete };
        (*place, *counts) = (*place + more, (i32::from(*counts) + more_counts) as u8);
        *mean = Mean { sum: mean.sum + more, count: mean.count + more_counts };
        if let Some(mean) = mean.value() {
            *offset = Some(mean);
        }
    }

    /// Correction to subtract from the untared θ_imu,i for θ_c,i: the tare's zero or, where offset_i is over the
    /// threshold, the offset, which includes the tare.
    #[inline]
    pub(crate) fn zero(&self, config: &AnchorConfig, zero: Turns) -> Turns {
        self.offset.filter(|offset| (*offset - zero).exceeds(config.threshold)).unwrap_or(zero)
    }

    /// The newest offset; `None` before the first.
    #[inline]
    #[must_use]
    pub const fn offset(&self) -> Option<Turns> {
        self.offset
    }
}

impl<const W: usize> Default for MovingAverageAnchor<W> {
    fn default() -> Self {
        Self::new()
    }
}

/// The paper's drift correction: an anchor for each segment.
#[derive(Debug, Clone)]
pub struct MovingAverage<const N: usize, const W: usize> {
    anchors: [MovingAverageAnchor<W>; N],
}

impl<const N: usize, const W: usize> MovingAverage<N, W> {
    /// Anchors before their first value.
    #[must_use]
    pub const fn new() -> Self {
        Self { anchors: [MovingAverageAnchor::new(); N] }
    }
}

impl<const N: usize, const W: usize> MovingAverage<N, W> {
    /// Clears all state at the start of a session.
    pub fn start(&mut self) {
        for anchor in &mut self.anchors {
            *anchor = MovingAverageAnchor::new();
        }
    }
}

impl<S: Scalar, const N: usize, const W: usize> DriftCorrection<S, N> for MovingAverage<N, W> {
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>, corrected: &mut CorrectedArm<N>) {
        let mut below = &SegmentHeading::BASE;
        let angles = corrected.imu.iter_mut().zip(&mut corrected.measured);
        let segments = self.anchors.iter_mut().zip(&sensed.headings).zip(&sensed.bend).zip(angles);
        for (((anchor, heading), bend), (theta, measured)) in segments.take(config.segments.len()) {
            let [difference, zero] = heading.relative_to(below);
            below = heading;
            anchor.push(sensed.decimated, difference.zip(bend.mean).map(|(imu, bend)| imu - bend.to_turns()));
            *theta = difference.zip(zero).map(|(imu, zero)| imu - anchor.zero(&config.anchor, zero));
            let both = theta.zip(bend.mean);
            *measured = MeasuredAngles {
                imu: both.map(|(imu, _)| imu),
                steps: Turns::ZERO,
                bend: both.map(|(_, bend)| bend.to_turns()),
            };
        }
    }
}
