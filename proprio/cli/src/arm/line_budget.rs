//! Load of the serial line by the messages of an arm, by protocol 3.

use serde::Serialize;

/// Bytes a second at 250 000 Bd, ten bits a byte.
pub const LINE_BYTES_PER_S: u32 = 25_000;

/// Bytes a second that the stream may take: four fifths, the rest is for replies, events and a slow host.
pub const STREAM_BYTES_PER_S: u32 = LINE_BYTES_PER_S / 5 * 4;

/// Ticks a second.
const TICKS_PER_S: u32 = 100;

/// Bytes of a frame beside its body: version, topic, sequence, CRC, COBS and zero.
const OVERHEAD: u32 = 10;

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
    pub const fn of(segments: u32, regulators: u32) -> Self {
        let whole = Self {
            samples: TICKS_PER_S * (OVERHEAD + 15 + 12 * segments),
            estimates: TICKS_PER_S * (OVERHEAD + 6 + 12 * segments),
            uncertainties: 4 * (OVERHEAD + 8 + 17 * segments),
            health: 5 * (OVERHEAD + 52 + 12 * segments + 5 * regulators),
            hello: OVERHEAD + 189,
            estimate_hz: TICKS_PER_S,
        };
        if whole.total() <= STREAM_BYTES_PER_S {
            whole
        } else {
            Self { estimates: whole.estimates / 2, estimate_hz: TICKS_PER_S / 2, ..whole }
        }
    }

    /// Bytes a second of all of them.
    pub const fn total(&self) -> u32 {
        self.samples + self.estimates + self.uncertainties + self.health + self.hello
    }

    /// True where the estimates' rate is halved.
    pub const fn is_halved(&self) -> bool {
        self.estimate_hz < TICKS_PER_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// docs/reference/protocol.md has this sum.
    #[test]
    fn six_segments_and_six_regulators_just_fit_at_100_hz() {
        let budget = LineBudget::of(6, 6);
        assert_eq!((budget.total(), budget.is_halved()), (19_999, false));
    }

    #[test]
    fn seven_and_eight_segments_get_an_estimate_every_second_tick() {
        for segments in [7, 8] {
            let budget = LineBudget::of(segments, 8);
            assert!(budget.is_halved() && budget.total() <= STREAM_BYTES_PER_S, "{budget:?}");
        }
        // 100 · (10 + 15 + 96) bytes of samples and 50 · (10 + 6 + 96) of estimates.
        let budget = LineBudget::of(8, 8);
        assert_eq!((budget.samples, budget.estimates), (12_100, 5_600));
    }
}
