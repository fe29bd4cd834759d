//! A clock divided from another, in exact arithmetic: the tick at an instant, and the instant of a tick.

use crate::model::{CYCLES_PER_SECOND, Cycles};

/// A clock of `hz / divisor` that ticked first, with tick 0, at `origin`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ticks {
    /// Instant of tick 0.
    pub origin: Cycles,
    /// Frequency of the source, Hz; zero: it does not run.
    pub hz: u32,
    /// Source periods in a tick; zero: it does not run.
    pub divisor: u32,
}

impl Ticks {
    /// The last tick at or before `at`; 0 before the origin.
    pub fn at(&self, at: Cycles) -> u64 {
        if self.stands() {
            return 0;
        }
        let elapsed = u128::from(at.saturating_sub(self.origin)) * u128::from(self.hz);
        (elapsed / (u128::from(CYCLES_PER_SECOND) * u128::from(self.divisor))) as u64
    }

    /// Instant of `tick`; `None` if the clock does not run.
    pub fn time(&self, tick: u64) -> Option<Cycles> {
        if self.stands() {
            return None;
        }
        let source_periods = u128::from(tick) * u128::from(self.divisor);
        let after = (source_periods * u128::from(CYCLES_PER_SECOND)).div_ceil(u128::from(self.hz));
        Some(self.origin.saturating_add(after.min(u128::from(u64::MAX)) as u64))
    }

    fn stands(&self) -> bool {
        self.hz == 0 || self.divisor == 0
    }
}

#[cfg(test)]
mod tests {
    use super::Ticks;

    #[test]
    fn a_tick_is_first_seen_at_its_time() {
        for (hz, divisor) in [(84_000_000, 2), (12_000_000, 128), (32_768, 1), (4_000_000, 3)] {
            let ticks = Ticks { origin: 1000, hz, divisor };
            for tick in [1, 2, 3, 1000, 123_457] {
                let time = ticks.time(tick).expect("it runs");
                assert_eq!((ticks.at(time - 1), ticks.at(time)), (tick - 1, tick), "{hz} / {divisor}");
            }
        }
    }
}
