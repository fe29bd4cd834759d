//! Schedule of the periodic messages.

use telemetry::{HELLO_TICKS, Rates};

/// Periods of the messages.
///
/// A message with a period of n is sent in the ticks that are multiples of n, so that samples and estimates of the same
/// period are of the same ticks, and the same rates give the same stream.
///
/// ```
/// use board_core::Schedule;
/// use telemetry::Rates;
///
/// let mut schedule = Schedule::of_arm(6, 6);
/// schedule.set(Rates { sample: 2, estimate: 1, health: 0, uncertainty: 0 });
/// let due = schedule.due(3);
/// assert!(!due.sample && due.estimate && !due.health && !due.uncertainty && !due.hello);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Schedule {
    rates: Rates,
    /// Shortest period of the estimates for which the line has room.
    shortest_estimate: u16,
}

/// Messages that are due in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one independent flag for each kind of message")]
pub struct DueMessages {
    /// A sample.
    pub sample: bool,
    /// An estimate.
    pub estimate: bool,
    /// A health message.
    pub health: bool,
    /// An uncertainty.
    pub uncertainty: bool,
    /// A hello.
    pub hello: bool,
}

impl Schedule {
    /// The schedule of an arm of so many segments and regulators until the host sets other rates.
    pub const fn of_arm(segments: usize, regulators: usize) -> Self {
        let rates = Rates::of_arm(segments, regulators);
        Self { rates, shortest_estimate: rates.estimate }
    }

    /// Sets the rates; estimates are not sent more often than the line has room for.
    pub fn set(&mut self, rates: Rates) {
        let estimate = if rates.estimate == 0 { 0 } else { rates.estimate.max(self.shortest_estimate) };
        self.rates = Rates { estimate, ..rates };
    }

    /// Messages that are due in this tick.
    pub fn due(&self, tick: u32) -> DueMessages {
        let every = |ticks: u16| tick.checked_rem(u32::from(ticks)) == Some(0);
        DueMessages {
            sample: every(self.rates.sample),
            estimate: every(self.rates.estimate),
            health: every(self.rates.health),
            uncertainty: every(self.rates.uncertainty),
            hello: every(HELLO_TICKS),
        }
    }
}
