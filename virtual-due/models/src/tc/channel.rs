//! A channel: registers, clock control and the counter (datasheet 36.6.2 to 36.6.7).

use super::mode::{Mode, Waveform};
use crate::model::{Context, Cycles};
use crate::ticks::Ticks;

const CCR: u32 = 0x00;
const CMR: u32 = 0x04;
const SMMR: u32 = 0x08;
const CV: u32 = 0x10;
const RA: u32 = 0x14;
const RB: u32 = 0x18;
const RC: u32 = 0x1C;
const SR: u32 = 0x20;
const IER: u32 = 0x24;
const IDR: u32 = 0x28;
const IMR: u32 = 0x2C;

const CLKEN: u32 = 1 << 0;
const CLKDIS: u32 = 1 << 1;
const SWTRG: u32 = 1 << 2;

pub const COVFS: u32 = 1 << 0;
pub const LOVRS: u32 = 1 << 1;
pub const CPAS: u32 = 1 << 2;
pub const CPBS: u32 = 1 << 3;
pub const CPCS: u32 = 1 << 4;
pub const LDRAS: u32 = 1 << 5;
pub const LDRBS: u32 = 1 << 6;
pub const ETRGS: u32 = 1 << 7;
const CLKSTA: u32 = 1 << 16;
const MTIOA: u32 = 1 << 17;
const MTIOB: u32 = 1 << 18;

/// Status bits that the counter itself sets.
const COUNTER_EVENTS: u32 = COVFS | CPAS | CPBS | CPCS;

/// True if WPMR protects the register at this offset of a channel (datasheet 36.7.21).
pub fn is_protected(offset: u32) -> bool {
    matches!(offset, CMR | SMMR | RA | RB | RC)
}

/// One channel.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flip-flop of figures 36-3 to 36-6")]
pub struct Channel {
    pub(super) mode: Mode,
    stepper_mode: u32,
    pub(super) ra: u32,
    pub(super) rb: u32,
    pub(super) rc: u32,
    /// Bits 7:0 of SR, which reading clears.
    pub(super) status: u32,
    interrupt_mask: u32,
    /// CLKSTA.
    clock_enabled: bool,
    /// A trigger has started the clock, and nothing has stopped it.
    started: bool,
    clock: Ticks,
    /// The counter held `value` at the clock's tick `value_tick`, and has met no register since.
    value: u32,
    value_tick: u64,
    counting_down: bool,
    pub(super) tioa: bool,
    pub(super) tiob: bool,
    /// Capture mode: RA has been loaded since the last trigger or load of RB; RA or RB unread since.
    pub(super) ra_loaded: bool,
    pub(super) unread: [bool; 2],
    /// TIOA may trigger the ADC: its edges are events.
    triggers: bool,
    /// Rising edges of such a TIOA that were not signalled yet.
    pub(super) edges: usize,
}

impl Channel {
    /// State after the chip's reset.
    pub fn new(triggers: bool) -> Self {
        Self {
            mode: Mode(0),
            stepper_mode: 0,
            ra: 0,
            rb: 0,
            rc: 0,
            status: 0,
            interrupt_mask: 0,
            clock_enabled: false,
            started: false,
            clock: Ticks { origin: 0, hz: 0, divisor: 1 },
            value: 0,
            value_tick: 0,
            counting_down: false,
            tioa: false,
            tiob: false,
            ra_loaded: false,
            unread: [false; 2],
            triggers,
            edges: 0,
        }
    }

    pub fn interrupt(&self) -> bool {
        self.status & self.interrupt_mask != 0
    }

    /// `None` where there is no such register. The write-only ones read as zero.
    pub fn read(&mut self, offset: u32, now: Cycles) -> Option<u32> {
        Some(match offset {
            CMR => self.mode.0,
            SMMR => self.stepper_mode,
            CV => self.counter(now),
            RA => {
                self.unread[0] = false;
                self.ra
            }
            RB => {
                self.unread[1] = false;
                self.rb
            }
            RC => self.rc,
            SR => std::mem::take(&mut self.status) | self.levels(),
            IMR => self.interrupt_mask,
            CCR | IER | IDR => 0,
            _ => return None,
        })
    }

    fn levels(&self) -> u32 {
        [(CLKSTA, self.clock_enabled), (MTIOA, self.tioa), (MTIOB, self.tiob)]
            .iter()
            .filter(|(_, set)| *set)
            .fold(0, |levels, (bit, _)| levels | bit)
    }

    /// False where there is no such register. RA and RB are read-only in capture mode.
    pub fn write(&mut self, offset: u32, value: u32, context: &mut Context) -> bool {
        self.latch_counter(context.now);
        match offset {
            CCR => self.control(value, context.now),
            CMR => {
                self.mode = Mode(value);
                self.counting_down &= self.mode.turns();
                self.follow_clock(context);
                if self.mode.has_burst_gate() {
                    return false;
                }
            }
            SMMR => self.stepper_mode = value & 3,
            RA if self.mode.is_waveform() => self.ra = value,
            RB if self.mode.is_waveform() => self.rb = value,
            RC => self.rc = value,
            IER => self.interrupt_mask |= value & 0xFF,
            IDR => self.interrupt_mask &= !value,
            CV | RA | RB | SR | IMR => {}
            _ => return false,
        }
        true
    }

    fn control(&mut self, value: u32, now: Cycles) {
        if value & CLKDIS != 0 {
            self.disable_clock(now);
        } else if value & CLKEN != 0 {
            self.clock_enabled = true;
        }
        if value & SWTRG != 0 {
            self.software_trigger(now);
        }
    }

    /// SWTRG, or SYNC of the block.
    pub fn software_trigger(&mut self, now: Cycles) {
        self.trigger(now);
        if self.mode.is_waveform() {
            self.set_tioa(self.mode.a_at_trigger());
            self.set_tiob(self.mode.b_at_trigger());
        }
    }

    /// Resets the counter, and starts its clock where that is enabled (datasheet 36.6.7).
    pub(super) fn trigger(&mut self, now: Cycles) {
        self.started = self.clock_enabled;
        self.clock.origin = now;
        self.value = 0;
        self.value_tick = 0;
        self.counting_down = false;
        self.ra_loaded = false;
    }

    pub(super) fn stop_clock(&mut self, now: Cycles) {
        self.latch_counter(now);
        self.started = false;
    }

    pub(super) fn disable_clock(&mut self, now: Cycles) {
        self.stop_clock(now);
        self.clock_enabled = false;
    }

    /// The counter's value; meaningful up to the next register that it meets.
    pub(super) fn counter(&self, now: Cycles) -> u32 {
        if !self.started {
            return self.value;
        }
        let passed = self.clock.at(now).saturating_sub(self.value_tick) as u32;
        if self.counting_down { self.value.wrapping_sub(passed) } else { self.value.wrapping_add(passed) }
    }

    /// Latches the counter's value now, so that registers written next have no effect on the past.
    fn latch_counter(&mut self, now: Cycles) {
        self.value = self.counter(now);
        if self.started {
            self.value_tick = self.value_tick.max(self.clock.at(now));
        }
    }

    /// Switches to a changed clock: the counter continues from its value.
    fn follow_clock(&mut self, context: &Context) {
        let (hz, divisor) = self.mode.clock(context.master_clock_hz);
        if (self.clock.hz, self.clock.divisor) != (hz, divisor) {
            self.latch_counter(context.now);
            self.clock = Ticks { origin: context.now, hz, divisor };
            self.value_tick = 0;
        }
    }

    /// Advances the counter to now, with all compare events on the way.
    pub fn advance(&mut self, context: &Context) {
        while let Some(at) = self.next_meeting_time().filter(|at| *at <= context.now) {
            self.advance_to_meeting(at);
        }
        self.follow_clock(context);
    }

    /// Instant of the next value at which something happens, by a clock of its own.
    pub fn next_meeting_time(&self) -> Option<Cycles> {
        self.next_meeting().and_then(|(ticks, _)| self.time_of(ticks))
    }

    /// Instant of a later tick of a clock of its own.
    pub fn time_of(&self, ticks: u64) -> Option<Cycles> {
        self.clock.time(self.value_tick.saturating_add(ticks))
    }

    /// Advances the counter to the next value at which something happens, at its instant.
    pub fn advance_to_meeting(&mut self, at: Cycles) {
        if let Some((ticks, value)) = self.next_meeting() {
            self.value_tick += ticks;
            self.value = value;
            self.meet(ticks, at);
        }
    }

    /// Counts one edge of an external clock.
    pub fn count_edge(&mut self, at: Cycles) {
        match self.next_meeting() {
            None => {}
            Some((1, value)) => {
                self.value = value;
                self.meet(1, at);
            }
            Some(_) if self.counting_down => self.value -= 1,
            Some(_) => self.value += 1,
        }
    }

    /// The next value at which something happens, and how many ticks away it is.
    pub(super) fn next_meeting(&self) -> Option<(u64, u32)> {
        if !self.started {
            return None;
        }
        let registers = [self.ra, self.rb, self.rc];
        if self.counting_down {
            let next = registers.into_iter().filter(|value| *value < self.value).max().unwrap_or(0);
            return Some((u64::from(self.value - next), next));
        }
        let top = if self.mode.turns() && self.value != u32::MAX { u64::from(u32::MAX) } else { 1 << 32 };
        let met = registers.into_iter().filter(|value| *value > self.value).min();
        let next = met.map_or(top, u64::from);
        Some((next - u64::from(self.value), next as u32))
    }

    fn meet(&mut self, ticks: u64, at: Cycles) {
        if self.value == 0 && ticks != 0 && !self.counting_down {
            self.status |= COVFS;
        }
        if self.mode.is_waveform() {
            self.meet_in_waveform_mode(at);
        } else if self.value == self.rc {
            self.status |= CPCS;
            if self.mode.rc_triggers() {
                self.restart();
                self.ra_loaded = false;
            }
        }
    }

    /// The counter begins again from 0 at the tick it is at.
    pub(super) fn restart(&mut self) {
        self.value = 0;
        self.counting_down = false;
    }

    /// At 0 there is only the way up.
    pub(super) fn turn(&mut self) {
        self.counting_down = !self.counting_down && self.value != 0;
    }

    pub(super) fn counter_value(&self) -> u32 {
        self.value
    }

    pub(super) fn counts_down(&self) -> bool {
        self.counting_down
    }

    /// 1 sets, 2 clears, 3 toggles.
    pub(super) fn set_tioa(&mut self, action: u32) {
        let level = after(action, self.tioa);
        if self.triggers && level && !self.tioa {
            self.edges += 1;
        }
        self.tioa = level;
    }

    /// TIOB is no output while it is the external event.
    pub(super) fn set_tiob(&mut self, action: u32) {
        if !self.mode.tiob_is_input() {
            self.tiob = after(action, self.tiob);
        }
    }

    /// True if an external event raises the interrupt.
    pub fn event_raises(&self) -> bool {
        self.interrupt_mask & ETRGS & !self.status != 0
    }

    /// Ticks to the counter's next event that raises the interrupt or moves a TIOA that may trigger the ADC.
    pub fn ticks_to_event(&self) -> Option<u64> {
        let raises = self.interrupt_mask & COUNTER_EVENTS & !self.status != 0;
        let moves = self.triggers && self.mode.is_waveform() && (self.mode.a_at_ra() != 0 || self.mode.a_at_rc() != 0);
        if !(raises || moves) {
            return None;
        }
        self.next_meeting().map(|(ticks, _)| ticks)
    }

    /// A lower bound of the ticks to the `count`th rise, or fall, of TIOA: two changes in one direction are a whole period
    /// apart, or two of three where the counter turns.
    pub fn ticks_to_edges(&self, count: u64) -> Option<u64> {
        let (first, _) = self.next_meeting()?;
        let top = if self.rc == 0 { 1 << 32 } else { u64::from(self.rc) };
        let (edges, period) = match self.mode.waveform() {
            Waveform::Up => (1, 1 << 32),
            Waveform::UpRc => (1, top),
            Waveform::UpDown => (2, 1 << 33),
            Waveform::UpDownRc => (2, 2 * top),
        };
        Some(first.saturating_add((count.saturating_sub(1) / edges).saturating_mul(period)))
    }

    /// Level of TIOA where it is an output.
    pub fn tioa_output(&self) -> Option<bool> {
        self.mode.is_waveform().then_some(self.tioa)
    }

    /// Level of TIOB where it is an output.
    pub fn tiob_output(&self) -> Option<bool> {
        (self.mode.is_waveform() && !self.mode.tiob_is_input()).then_some(self.tiob)
    }

    /// True if the counter runs.
    pub fn runs(&self) -> bool {
        self.started
    }
}

fn after(action: u32, level: bool) -> bool {
    match action {
        1 => true,
        2 => false,
        3 => !level,
        _ => level,
    }
}
