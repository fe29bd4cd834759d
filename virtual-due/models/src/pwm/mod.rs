//! The PWM controller (datasheet chapter 38): eight channels, of which the world sees the PWML pins on PIOC.
//!
//! With its dead-time generator off a channel's PWML is the complement of its comparator's output OC (datasheet 38.6.2.3), so
//! that at CPOL = 0, where OC is low for the first CDTY clocks of a period, PWML is high for CDTY of CPRD clocks. OC of a
//! channel that is off rests at CPOL: PWML of such a channel is high at CPOL = 0.
//!
//! Faults, event lines, and the stepper mode are stored and reported; the counter event in the middle of a period (CES) is not
//! made.

mod channel;
mod comparison;
mod protection;
mod registers;
mod synchronous;

use crate::model::{Context, Cycles};
use crate::pdc::Pdc;
use channel::{CHANNELS, Channel, Timing, channel_clock};
use comparison::Comparison;
use protection::Protection;
use synchronous::Synchronous;

/// PIOC lines of PWML0 … PWML7, as peripheral B (datasheet 9.3.3).
const LOW_SIDE_LINES: [u32; CHANNELS] = [2, 4, 6, 8, 21, 22, 23, 24];

/// The controller.
#[derive(Debug, Clone)]
pub struct Pwm {
    clock: u32,
    channels: [Channel; CHANNELS],
    synchronous: Synchronous,
    comparisons: [Comparison; 8],
    /// ISR1 and ISR2, which reading clears, and their masks.
    channel_status: u32,
    channel_mask: u32,
    update_status: u32,
    update_mask: u32,
    override_values: u32,
    /// OS, and what OSSUPD and OSCUPD set and clear at the ends of periods.
    overridden: u32,
    override_set: u32,
    override_clear: u32,
    fault: [u32; 4],
    event_lines: [u32; 2],
    stepper: u32,
    protection: Protection,
    pdc: Pdc,
    /// Lines of PIOC that belong to peripheral B.
    pins: u32,
    /// Duty of each channel as last reported to the world.
    reported: [Option<(u32, u32)>; CHANNELS],
}

impl Default for Pwm {
    fn default() -> Self {
        Self::new()
    }
}

impl Pwm {
    /// State after the chip's reset.
    pub fn new() -> Self {
        Self {
            clock: 0,
            channels: std::array::from_fn(|_| Channel::default()),
            synchronous: Synchronous::default(),
            comparisons: std::array::from_fn(|_| Comparison::default()),
            channel_status: 0,
            channel_mask: 0,
            update_status: 0,
            update_mask: 0,
            override_values: 0,
            overridden: 0,
            override_set: 0,
            override_clear: 0,
            fault: [0; 4],
            event_lines: [0; 2],
            stepper: 0,
            protection: Protection::default(),
            pdc: Pdc::new(),
            pins: 0,
            reported: [None; CHANNELS],
        }
    }

    /// The channel whose counter, period and alignment a channel uses: synchronous ones share channel 0's.
    fn leader(&self, index: usize) -> usize {
        if self.synchronous.includes(index) { 0 } else { index }
    }

    fn timing(&self, index: usize) -> Timing {
        self.channels[self.leader(index)].timing()
    }

    fn enable(&mut self, channels: u32, context: &mut Context) {
        let channels = if channels & 1 == 0 { channels } else { channels | self.synchronous.channels() };
        for index in 0..CHANNELS {
            if channels & (1 << index) != 0 {
                let clock = channel_clock(self.channels[index].mode, self.clock, context.master_clock_hz);
                self.channels[index].enable(clock, context.now);
            }
        }
        self.report_duties(context.now, context);
    }

    /// Disabling waits for the end of the period.
    fn disable(&mut self, channels: u32) {
        let channels = if channels & 1 == 0 { channels } else { channels | self.synchronous.channels() };
        for (index, channel) in self.channels.iter_mut().enumerate() {
            channel.stopping |= channel.enabled && channels & (1 << index) != 0;
        }
    }

    /// SR.
    fn enabled(&self) -> u32 {
        (0..CHANNELS).filter(|index| self.channels[*index].enabled).fold(0, |bits, index| bits | 1 << index)
    }

    /// Bits of OS, OSSUPD and OSCUPD of a channel: its high side and its low side.
    fn override_bits(index: usize) -> u32 {
        0x1_0001 << index
    }

    /// A channel and, with channel 0, those that follow it.
    fn members(&self, index: usize) -> impl Iterator<Item = usize> + use<> {
        let followers = if index == 0 { self.synchronous.channels() } else { 0 };
        (0..CHANNELS).filter(move |member| *member == index || followers & (1 << member) != 0)
    }

    /// True if the end of a period of this channel changes more than its flag.
    fn acts_at_period_end(&self, index: usize) -> bool {
        let waits = |member: usize| {
            let overrides = (self.override_set | self.override_clear) & Self::override_bits(member) != 0;
            self.channels[member].stopping || overrides
        };
        let updates = !self.synchronous.includes(index) && self.channels[index].has_update();
        let leads = index == 0 && self.synchronous.channels() != 0 && self.synchronous.acts();
        let compares = index == 0 && self.comparisons.iter().any(Comparison::runs);
        updates || leads || compares || self.members(index).any(waits)
    }

    fn advance_channel(&mut self, index: usize, context: &mut Context) {
        while let Some(end) = self.channels[index].period_end(self.timing(index))
            && end <= context.now
        {
            self.channel_status |= 1 << index;
            let timing = self.timing(index);
            if self.acts_at_period_end(index) {
                self.channels[index].next_period(timing);
                self.end_period(index, end, context);
            } else {
                self.channels[index].skip_periods(timing, context.now);
            }
        }
    }

    /// Applies the changes that wait for the end of a period of a channel, and of those that follow it.
    fn end_period(&mut self, index: usize, end: Cycles, context: &mut Context) {
        for member in self.members(index) {
            self.channels[member].stop_if_requested();
            let bits = Self::override_bits(member);
            self.overridden = (self.overridden | self.override_set & bits) & !(self.override_clear & bits);
            self.override_set &= !bits;
            self.override_clear &= !bits;
        }
        if !self.synchronous.includes(index) {
            self.channels[index].update_all();
        }
        if index == 0 && self.synchronous.channels() != 0 {
            let status = self.synchronous.end_period(&mut self.channels, &mut self.pdc, context.memory);
            self.update_status |= status;
        }
        if index == 0 {
            for (bit, comparison) in (0..).zip(&mut self.comparisons) {
                self.update_status |= comparison.end_period(bit);
            }
        }
        self.report_duties(end, context);
    }

    /// High clocks of PWML and clocks of its period; `None` where the pin is not the PWM's.
    fn low_side(&self, index: usize) -> Option<(u32, u32)> {
        if self.pins & (1 << LOW_SIDE_LINES[index]) == 0 {
            return None;
        }
        let bit = 1 << (16 + index);
        Some(if self.overridden & bit == 0 {
            self.channels[index].low_side(self.timing(index))
        } else {
            (u32::from(self.override_values & bit != 0), 1)
        })
    }

    /// Level of PWML.
    fn low_side_level(&self, index: usize, now: Cycles) -> bool {
        let bit = 1 << (16 + index);
        if self.overridden & bit == 0 {
            self.channels[index].low_side_level(self.timing(index), now)
        } else {
            self.override_values & bit != 0
        }
    }

    /// Reports changed duties to the world.
    fn report_duties(&mut self, at: Cycles, context: &mut Context) {
        for index in 0..CHANNELS {
            let duty = self.low_side(index);
            if duty != self.reported[index] {
                self.reported[index] = duty;
                context.world.pwm(index as u8, duty, at);
            }
        }
    }

    fn update_status(&self) -> u32 {
        let end = if self.pdc.end_of_transmit() { synchronous::ENDTX } else { 0 };
        let empty = if self.pdc.transmit_buffer_empty() { synchronous::TXBUFE } else { 0 };
        self.update_status | end | empty
    }
}

#[cfg(test)]
mod tests;
