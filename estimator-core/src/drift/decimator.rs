//! Decimator: from the sample rate down to the anchor's, and the stagger of the segments between two values.

use core::ops::Range;

use crate::config::AnchorConfig;

/// Decimator from the sample rate to the anchor's rate; the same for all segments.
#[derive(Debug, Clone, Copy, Default)]
pub struct Decimator {
    /// Phase accumulator: grows by the anchor's rate with each sample, and wraps at the sample rate.
    phase: u32,
    oldest: u16,
}

/// Output of [`Decimator`] for one sample.
#[derive(Debug, Clone, Copy)]
pub struct Decimated {
    pub(crate) oldest: u16,
    /// Mask: all ones where a value is complete, else zero.
    pub(crate) complete: i32,
}

impl Decimated {
    #[inline]
    pub(crate) const fn is_complete(self) -> bool {
        self.complete != 0
    }
}

impl Decimator {
    /// At the start of a session.
    #[must_use]
    pub const fn new() -> Self {
        Self { phase: 0, oldest: 0 }
    }

    /// Advances by one sample.
    pub fn advance(&mut self, config: &AnchorConfig) -> Decimated {
        self.phase = self.phase.saturating_add(config.rate_millihertz);
        let complete = self.phase >= config.sample_rate_millihertz;
        let decimated = Decimated { oldest: self.oldest, complete: -i32::from(complete) };
        if complete {
            self.phase = (self.phase - config.sample_rate_millihertz).min(config.sample_rate_millihertz);
            self.oldest = if self.oldest + 1 < config.window { self.oldest + 1 } else { 0 };
        }
        decimated
    }

    /// Range of phases of the newest sample. The ranges of all samples from one complete value to the next cover each
    /// phase from 0 to the sample rate once.
    pub(crate) fn stagger(self, config: &AnchorConfig, decimated: Decimated) -> Range<u32> {
        let first = if decimated.is_complete() { 0 } else { self.phase };
        first..self.phase.saturating_add(config.rate_millihertz)
    }
}
