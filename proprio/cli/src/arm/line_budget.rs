//! Load of the serial line by the messages of an arm, by protocol 3.

use serde::Serialize;
use telemetry::{FrameLengths, HELLO_TICKS, Rates, TICK_HZ};

/// Bytes a second of an arm's messages, at worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct LineBudget {
    /// Samples, one each tick.
    pub samples: u32,
    /// Estimates, at [`estimate_hz`](Self::estimate_hz).
    pub estimates: u32,
    /// Uncertainties, at 4 Hz.
    pub uncertainties: u32,
    /// Health messages, at 5 Hz.
    pub health: u32,
    /// The `Hello`, once a second.
    pub hello: u32,
    /// Estimates a second: one each tick, or each second one where that would be too much.
    pub estimate_hz: u32,
}

impl LineBudget {
    /// The budget of an arm of so many segments and regulators.
    pub fn of(segments: usize, regulators: usize) -> Self {
        let (lengths, rates) = (FrameLengths::of(segments, regulators), Rates::of_arm(segments, regulators));
        Self {
            samples: lengths.sample * per_second(rates.sample),
            estimates: lengths.estimate * per_second(rates.estimate),
            uncertainties: lengths.uncertainty * per_second(rates.uncertainty),
            health: lengths.health * per_second(rates.health),
            hello: lengths.hello * per_second(HELLO_TICKS),
            estimate_hz: per_second(rates.estimate),
        }
    }

    /// Bytes a second of all of them.
    pub const fn total(&self) -> u32 {
        self.samples + self.estimates + self.uncertainties + self.health + self.hello
    }

    /// True where the estimates' rate is halved.
    pub const fn is_halved(&self) -> bool {
        self.estimate_hz < TICK_HZ as u32
    }
}

/// Messages a second, one in so many ticks.
fn per_second(ticks: u16) -> u32 {
    TICK_HZ as u32 / u32::from(ticks)
}

#[cfg(test)]
mod tests {
    use telemetry::STREAM_BYTES_PER_SECOND;

    use super::*;

    /// docs/reference/protocol.md has this sum.
    #[test]
    fn six_segments_and_six_regulators_just_fit_at_100_hz() {
        let budget = LineBudget::of(6, 6);
        assert_eq!((budget.total(), budget.is_halved()), (19_887, false));
    }

    #[test]
    fn seven_and_eight_segments_get_an_estimate_every_second_tick() {
        for segments in [7, 8] {
            let budget = LineBudget::of(segments, 8);
            assert!(budget.is_halved() && budget.total() <= STREAM_BYTES_PER_SECOND, "{budget:?}");
        }
        // 100 · (10 + 15 + 96) bytes of samples and 50 · (10 + 6 + 96) of estimates.
        let budget = LineBudget::of(8, 8);
        assert_eq!((budget.samples, budget.estimates), (12_100, 5_600));
    }
}
