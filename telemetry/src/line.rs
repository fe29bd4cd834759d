//! Budget of the line: the lengths of the frames of an arm, and the rates at which they fit.

use crate::constants::TICK_US;
use crate::request::Rates;

/// Bytes a second at 250 000 Bd; a byte takes ten bits with its start and stop bit.
pub const LINE_BYTES_PER_SECOND: u32 = 25_000;

/// Bytes a second that the periodic messages may take: four fifths; the rest is for replies, events and a slow host.
pub const STREAM_BYTES_PER_SECOND: u32 = LINE_BYTES_PER_SECOND / 5 * 4;

/// Ticks from one [`Hello`](crate::Hello) to the next: once a second at any rates.
pub const HELLO_TICKS: u16 = 100;

/// Ticks a second.
const TICKS_PER_SECOND: u32 = 1_000_000 / TICK_US as u32;

/// Lengths of the longest frames of an arm, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameLengths {
    /// A [`Sample`](crate::Sample).
    pub sample: u32,
    /// An [`Estimate`](crate::Estimate).
    pub estimate: u32,
    /// A [`Health`](crate::Health).
    pub health: u32,
    /// An [`Uncertainty`](crate::Uncertainty).
    pub uncertainty: u32,
    /// A [`Hello`](crate::Hello).
    pub hello: u32,
}

impl FrameLengths {
    /// Those of an arm of so many segments and regulators.
    #[must_use]
    pub const fn of(segments: usize, regulators: usize) -> Self {
        let (segments, regulators) = (segments as u32, regulators as u32);
        Self {
            sample: 25 + 12 * segments,
            estimate: 16 + 12 * segments,
            health: 69 + 13 * segments + 5 * regulators,
            uncertainty: 18 + 17 * segments,
            hello: 199,
        }
    }

    /// Bytes a second of the periodic messages at these rates, at worst.
    #[must_use]
    pub const fn bytes_per_second(&self, rates: Rates) -> u32 {
        per_second(self.sample, rates.sample)
            + per_second(self.estimate, rates.estimate)
            + per_second(self.health, rates.health)
            + per_second(self.uncertainty, rates.uncertainty)
            + per_second(self.hello, HELLO_TICKS)
    }
}

/// Bytes a second of frames of this length every so many ticks; 0: never.
const fn per_second(length: u32, ticks: u16) -> u32 {
    if ticks == 0 { 0 } else { length * TICKS_PER_SECOND / ticks as u32 }
}

impl Rates {
    /// Rates of an arm until the host sets others: samples and estimates every tick, health and uncertainty at 4 Hz.
    /// Where they do not fit the line, estimates are sent every second tick.
    #[must_use]
    pub const fn of_arm(segments: usize, regulators: usize) -> Self {
        let every_tick = Self { sample: 1, estimate: 1, health: 25, uncertainty: 25 };
        if FrameLengths::of(segments, regulators).bytes_per_second(every_tick) <= STREAM_BYTES_PER_SECOND {
            every_tick
        } else {
            Self { estimate: 2, ..every_tick }
        }
    }
}
