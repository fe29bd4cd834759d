//! Which messages are due in a tick.

use telemetry::Rates;

/// What is sent until the host asks for something else: samples and estimates every tick, health at 5 Hz, uncertainty at 4 Hz,
/// which the line has just room for.
pub const DEFAULT_RATES: Rates = Rates { sample: 1, estimate: 1, health: 20, uncertainty: 25 };

/// Ticks of 10 ms from one hello to the next: it comes once a second whatever the rates are.
pub const HELLO_TICKS: u16 = 100;

/// How often messages are sent.
///
/// A message with a rate of n goes out in the ticks that are multiples of n, so that samples and estimates of the same
/// rate belong to the same ticks, and the same rates give the same stream.
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

/// What is due in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one for each kind of message, each by itself")]
pub struct Due {
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
    /// Sends at these rates.
    pub const fn new(rates: Rates) -> Self {
        Self { rates }
    }

    /// What is due in this tick.
    pub fn due(&self, tick: u32) -> Due {
        let every = |ticks: u16| tick.checked_rem(u32::from(ticks)) == Some(0);
        Due {
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
