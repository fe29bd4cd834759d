//! Schedule of the periodic messages.

use telemetry::Rates;

/// Rates until the host sets others: samples and estimates every tick, health at 5 Hz, uncertainty at 4 Hz, which just fit
/// the line.
pub const DEFAULT_RATES: Rates = Rates { sample: 1, estimate: 1, health: 20, uncertainty: 25 };

/// Ticks of 10 ms from one hello to the next: once a second at any rates.
pub const HELLO_TICKS: u16 = 100;

/// Periods of the messages.
///
/// A message with a period of n is sent in the ticks that are multiples of n, so that samples and estimates of the same
/// period are of the same ticks, and the same rates give the same stream.
///
/// ```
/// use board_core::Schedule;
/// use telemetry::Rates;
///
/// let schedule = Schedule::new(Rates { sample: 2, estimate: 1, health: 0, uncertainty: 0 });
/// let due = schedule.due(3);
/// assert!(!due.sample && due.estimate && !due.health && !due.uncertainty && !due.hello);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Schedule {
    rates: Rates,
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
    /// A schedule of these rates.
    pub const fn new(rates: Rates) -> Self {
        Self { rates }
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

impl Default for Schedule {
    fn default() -> Self {
        Self::new(DEFAULT_RATES)
    }
}
