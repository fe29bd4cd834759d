//! Leaky counter of missed readings: detects sensors with frequent gaps.
//!
//! Each missed reading adds [`MISS`] to the level, each good one takes 1 away: more than one miss in twenty raises it.
//! A sensor is intermittent from [`FULL`] on, which every second reading lost reaches in 110 ms, until the level is zero.

/// Level of one missed reading.
const MISS: u8 = 20;
/// Level from which on a sensor is intermittent: five misses at once. It rises no further.
const FULL: u8 = 100;

/// Leaky count of one sensor.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct GapCounter {
    level: u8,
    is_intermittent: bool,
}

impl GapCounter {
    /// Counts the reading of a tick. Returns whether the sensor is intermittent.
    pub(crate) fn update(&mut self, is_read: bool) -> bool {
        self.level = if is_read { self.level.saturating_sub(1) } else { self.level.saturating_add(MISS).min(FULL) };
        self.is_intermittent = self.level >= FULL || (self.is_intermittent && self.level > 0);
        self.is_intermittent
    }
}
