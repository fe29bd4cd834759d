//! Drift anchor: the moving average of what the IMUs say beyond the bend sensors (paper, eq. 2 and 3).

use core::ops::Range;

use crate::angle::Turns;

/// When the anchor averages and when it corrects; the same for all segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnchorRule {
    /// Length of the window, in values.
    pub window: u16,
    /// Rate of the window's values, mHz. Above the sample rate, every sample is a value.
    pub rate_millihertz: u32,
    /// Rate of the samples, mHz; those between two values are averaged.
    pub sample_rate_millihertz: u32,
    /// Offsets up to this size are left alone.
    pub threshold: Turns,
}

/// Moving average over `window` values of θ_imu,i − θ_bend,i for one segment, of up to `W` values.
///
/// As both means of the paper run over the same samples, offset_i = MA(θ_imu,i) − MA(θ_bend,i) is one mean of the
/// differences. The sum is of whole numbers and therefore exact however long it runs. Where a sample lacks one of the
/// two, its place in the window stays empty; when the whole window is empty, the newest offset holds.
///
/// ```
/// use estimator_core::{Anchor, AnchorRule, Pace, Turns};
///
/// let rule = AnchorRule {
///     window: 2,
///     rate_millihertz: 10_000,
///     sample_rate_millihertz: 10_000,
///     threshold: Turns::ZERO,
/// };
/// let (mut pace, mut anchor) = (Pace::new(), Anchor::<2>::new());
/// for value in [1, 3, 5] {
///     anchor.push(pace.tick(&rule), Some(Turns::from_bits(value)));
/// }
/// assert_eq!(anchor.offset(), Some(Turns::from_bits(4)));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Anchor<const W: usize> {
    offset: Option<Turns>,
    mean: Mean,
    group: Mean,
    /// The values; a missing one is zero, and its count is none.
    window: [Turns; W],
    counts: [u8; W],
}

/// When a value of the window is complete and which it replaces; the same for the anchors of all segments.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pace {
    /// How much of the time to the next value has passed: adds the anchor's rate a sample, up to the sample rate.
    phase: u32,
    oldest: u16,
}

/// What [`Pace`] says of one sample.
#[derive(Debug, Clone, Copy)]
pub struct Slot {
    oldest: u16,
    /// All ones where a value is complete, else zero.
    complete: i32,
}

impl Slot {
    #[inline]
    pub(crate) const fn is_complete(self) -> bool {
        self.complete != 0
    }
}

impl Pace {
    /// At the start of a session.
    #[must_use]
    pub const fn new() -> Self {
        Self { phase: 0, oldest: 0 }
    }

    /// Takes one sample's time.
    pub fn tick(&mut self, rule: &AnchorRule) -> Slot {
        self.phase = self.phase.saturating_add(rule.rate_millihertz);
        let complete = self.phase >= rule.sample_rate_millihertz;
        let slot = Slot { oldest: self.oldest, complete: -i32::from(complete) };
        if complete {
            self.phase = (self.phase - rule.sample_rate_millihertz).min(rule.sample_rate_millihertz);
            self.oldest = if self.oldest + 1 < rule.window { self.oldest + 1 } else { 0 };
        }
        slot
    }

    /// The phases that belong to the newest sample: those of all samples from one complete value to the next are those
    /// from 0 to the sample rate, each once.
    pub(crate) fn phases(self, rule: &AnchorRule, slot: Slot) -> Range<u32> {
        let first = if slot.is_complete() { 0 } else { self.phase };
        first..self.phase.saturating_add(rule.rate_millihertz)
    }
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

impl<const W: usize> Anchor<W> {
    /// An anchor that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { offset: None, mean: Mean::EMPTY, group: Mean::EMPTY, window: [Turns::ZERO; W], counts: [0; W] }
    }

    /// Takes this sample's difference θ_imu,i − θ_bend,i, or `None` where one of the two is unknown.
    ///
    /// Every sample costs the same, whether it completes a value of the window or not.
    #[inline]
    pub fn push(&mut self, slot: Slot, difference: Option<Turns>) {
        self.take(difference.unwrap_or_default(), i32::from(difference.is_some()), slot);
    }

    /// Out of line, with all registers for itself.
    #[inline(never)]
    fn take(&mut self, sum: Turns, count: i32, Slot { oldest, complete }: Slot) {
        let Self { offset, mean, group, window, counts } = self;
        let k = usize::from(oldest);
        let (Some(place), Some(counts)) = (window.get_mut(k), counts.get_mut(k)) else { return };
        let whole = Mean { sum: group.sum + sum, count: group.count + count };
        let newest = whole.value();
        // What is not complete adds nothing: by masks, which cost the same.
        let more = (newest.unwrap_or_default() - *place).masked(complete);
        let more_counts = (i32::from(newest.is_some()) - i32::from(*counts)) & complete;
        *group = Mean { sum: whole.sum.masked(!complete), count: whole.count & !complete };
        (*place, *counts) = (*place + more, (i32::from(*counts) + more_counts) as u8);
        *mean = Mean { sum: mean.sum + more, count: mean.count + more_counts };
        if let Some(mean) = mean.value() {
            *offset = Some(mean);
        }
    }

    /// What to subtract from the untared θ_imu,i for θ_c,i: the tare's zero, or, where offset_i is over the threshold, the
    /// offset, in whose values the tare is still.
    #[inline]
    pub(crate) fn zero(&self, rule: &AnchorRule, zero: Turns) -> Turns {
        self.offset.filter(|offset| (*offset - zero).exceeds(rule.threshold)).unwrap_or(zero)
    }

    /// The newest offset; `None` before the first.
    #[inline]
    #[must_use]
    pub const fn offset(&self) -> Option<Turns> {
        self.offset
    }
}

impl<const W: usize> Default for Anchor<W> {
    fn default() -> Self {
        Self::new()
    }
}
