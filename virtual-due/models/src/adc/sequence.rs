//! The order and the timing of conversions (datasheet 43.6.5 to 43.6.10).

use super::fields::Mode;
use crate::model::{Context, Cycles};

/// Registers that set up sequences.
#[derive(Debug, Clone, Copy)]
pub struct Setup {
    pub mode: Mode,
    /// CHSR.
    pub enabled: u16,
    /// SEQR1 and SEQR2.
    pub user_sequence: [u32; 2],
}

impl Setup {
    /// The first enabled place from `first` on: a channel, or with USEQ a field of SEQR1 and SEQR2.
    fn place_from(&self, first: u8) -> Option<u8> {
        (first..16).find(|place| self.enabled & (1 << place) != 0)
    }

    fn channel(&self, place: u8) -> u8 {
        if self.mode.user_sequence() {
            let [first, second] = self.user_sequence;
            (((u64::from(second) << 32 | u64::from(first)) >> (4 * place)) & 15) as u8
        } else {
            place
        }
    }
}

/// A conversion under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conversion {
    place: u8,
    /// The channel.
    pub channel: u8,
    /// End of tracking.
    pub sampled_at: Cycles,
    ends_at: Cycles,
}

/// The sequencer.
#[derive(Debug, Clone, Default)]
pub struct Sequence {
    running: Option<Conversion>,
    /// True if the cell has started since it was last off.
    awake: bool,
}

impl Sequence {
    /// A trigger: the cell wakes, if it was off, and converts all enabled channels. While a sequence is under way there is
    /// nothing to start.
    pub fn start(&mut self, at: Cycles, setup: Setup, context: &Context) {
        if self.running.is_some() {
            return;
        }
        let startup = if self.awake { 0 } else { setup.mode.startup_clocks() };
        self.begin(0, at + context.master_cycles(startup * setup.mode.clock_divisor()), setup, context);
        self.awake |= self.running.is_some();
    }

    /// The next conversion, at the first enabled place from `first` on. A channel that was enabled or disabled meanwhile
    /// counts as it is now.
    fn begin(&mut self, first: u8, at: Cycles, setup: Setup, context: &Context) {
        let clocks = |count: u64| context.master_cycles(count * setup.mode.clock_divisor());
        self.running = setup.place_from(first).map(|place| Conversion {
            place,
            channel: setup.channel(place),
            sampled_at: at + clocks(setup.mode.tracking_clocks()),
            ends_at: at + clocks(setup.mode.conversion_clocks()),
        });
    }

    /// The conversion that is complete by `now`; the next one has then begun.
    pub fn take_completed(&mut self, setup: Setup, context: &Context) -> Option<Conversion> {
        let done = self.running.take_if(|conversion| conversion.ends_at <= context.now)?;
        self.begin(done.place + 1, done.ends_at, setup, context);
        if self.running.is_none() && setup.mode.free_running() {
            self.begin(0, done.ends_at, setup, context);
        }
        if self.running.is_none() && setup.mode.sleeps() {
            self.awake = false;
        }
        Some(done)
    }

    /// End of the conversion under way.
    pub fn next_event(&self) -> Option<Cycles> {
        self.running.map(|conversion| conversion.ends_at)
    }
}
