//! A timer counter block (datasheet chapter 36): three channels of 32 bits, each with an interrupt of its own.
//!
//! Channel `c` has its registers at `0x40 · c`; the block's own follow at 0xC0. There is an interrupt line for each
//! channel. Block 0 signals the rising edges of its TIOA outputs, which may trigger the ADC, each at its time. The quadrature
//! decoder and the burst gates are not modelled, and nothing drives the pins TCLK0 to TCLK8.

mod capture;
mod chaining;
mod channel;
mod mode;
mod waveform;

use crate::model::{Context, Cycles, Peripheral, Pin, Side, Signal};
use crate::write_protection::WriteProtection;
use channel::Channel;

const BCR: u32 = 0xC0;
const BMR: u32 = 0xC4;
const QIER: u32 = 0xC8;
const QIDR: u32 = 0xCC;
const QIMR: u32 = 0xD0;
const QISR: u32 = 0xD4;
const FMR: u32 = 0xD8;
const WPMR: u32 = 0xE4;

const SYNC: u32 = 1;
const QDEN: u32 = 1 << 8;

/// TIOA and TIOB of the nine channels: as peripheral A on PIOA, as peripheral B elsewhere (datasheet 9.3).
const PINS: [(Pin, Pin); 9] = [
    (pin(1, 25), pin(1, 27)),
    (pin(0, 2), pin(0, 3)),
    (pin(0, 5), pin(0, 6)),
    (pin(1, 0), pin(1, 1)),
    (pin(1, 2), pin(1, 3)),
    (pin(1, 4), pin(1, 5)),
    (pin(2, 25), pin(2, 26)),
    (pin(2, 28), pin(2, 29)),
    (pin(3, 7), pin(3, 8)),
];

const fn pin(port: u8, line: u8) -> Pin {
    Pin { port, line }
}

/// A block of three channels.
#[derive(Debug, Clone)]
pub struct Tc {
    block: usize,
    channels: [Channel; 3],
    /// Levels of TIOA whose edges the chained channels have counted.
    levels: [bool; 3],
    block_mode: u32,
    fault_mode: u32,
    protection: WriteProtection,
}

impl Tc {
    /// TC0, TC1 or TC2 after the chip's reset.
    pub fn new(block: usize) -> Self {
        Self {
            block,
            channels: std::array::from_fn(|_| Channel::new(block == 0)),
            levels: [false; 3],
            block_mode: 0,
            fault_mode: 0,
            protection: WriteProtection::new(*b"TIM"),
        }
    }

    /// Passes edges of TIOA on, to chained channels and to the chip.
    fn signal_edges(&mut self, context: &mut Context) {
        self.count_edges(context.now);
        for (number, channel) in (0..).zip(&mut self.channels) {
            let edges = std::mem::take(&mut channel.edges);
            context.signals.extend((0..edges).map(|_| Signal::Tioa(number)));
        }
    }

    /// Samples the outside levels of the channels' pins; of edges between two samples only the last is detected.
    fn watch_pins(&mut self, context: &mut Context) {
        let pins = PINS[3 * self.block..].iter();
        for (channel, (tioa, tiob)) in self.channels.iter_mut().zip(pins) {
            if let Some(level) = context.world.level(*tioa, context.now) {
                channel.drive_tioa(level, context.now);
            }
            if let Some(level) = context.world.level(*tiob, context.now) {
                channel.drive_tiob(level, context.now);
            }
        }
    }

    /// Warns of running channels whose clock is a pin.
    fn check_clocks(&self, context: &mut Context) {
        for (index, pin) in (0..3).filter_map(|index| Some((index, self.missing_clock(index)?))) {
            let name = self.name();
            let text =
                format!("{name}: channel {index} stands still: its clock is the pin TCLK{pin}, which nothing drives");
            context.warnings.warn_once(text);
        }
    }

    fn name(&self) -> &'static str {
        ["TC0", "TC1", "TC2"].get(self.block).copied().unwrap_or("TC")
    }

    fn write_block(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            BCR if value & SYNC != 0 => {
                for channel in &mut self.channels {
                    channel.software_trigger(context.now);
                }
            }
            BMR if self.protection.permits(offset) => {
                self.set_block_mode(value);
                if value & QDEN != 0 {
                    context.warnings.unmodelled(self.name(), offset);
                }
            }
            FMR if self.protection.permits(offset) => self.fault_mode = value & 3,
            WPMR => self.protection.set_mode(value),
            QIER if value != 0 => context.warnings.unmodelled(self.name(), offset),
            BCR | BMR | FMR | QIER | QIDR | QIMR | QISR => {}
            _ => context.warnings.unmodelled(self.name(), offset),
        }
    }

    fn read_block(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            BMR => self.block_mode,
            FMR => self.fault_mode,
            WPMR => self.protection.mode(),
            BCR | QIER | QIDR | QIMR | QISR => 0,
            _ => {
                context.warnings.unmodelled(self.name(), offset);
                0
            }
        }
    }
}

impl Peripheral for Tc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        let value = match self.channels.get_mut((offset / 0x40) as usize) {
            Some(channel) => channel.read(offset % 0x40, context.now),
            None => return self.read_block(offset, context),
        };
        value.unwrap_or_else(|| {
            context.warnings.unmodelled(self.name(), offset);
            0
        })
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        let name = self.name();
        let Some(channel) = self.channels.get_mut((offset / 0x40) as usize) else {
            self.write_block(offset, value, context);
            self.signal_edges(context);
            self.check_clocks(context);
            return;
        };
        if channel::is_protected(offset % 0x40) && !self.protection.permits(offset) {
            return;
        }
        if !channel.write(offset % 0x40, value, context) {
            context.warnings.unmodelled(name, offset);
        }
        self.signal_edges(context);
        self.check_clocks(context);
    }

    fn advance(&mut self, context: &mut Context) {
        self.advance_channels(context);
        self.watch_pins(context);
        self.signal_edges(context);
    }

    fn next_output_edge(&self, pin: Pin, side: Side, now: Cycles) -> Option<Cycles> {
        let mut pins = PINS[3 * self.block..].iter().take(3);
        let index = pins.position(|(tioa, tiob)| pin == *tioa || pin == *tiob)?;
        self.output(pin, side, now)?;
        self.next_meeting(index)
    }

    fn output(&self, pin: Pin, side: Side, _now: Cycles) -> Option<bool> {
        let expected = if pin.port == 0 { Side::A } else { Side::B };
        let mut outputs = PINS[3 * self.block..].iter().zip(&self.channels).filter(|_| side == expected);
        outputs.find_map(|((tioa, tiob), channel)| match pin {
            _ if pin == *tioa => channel.tioa_output(),
            _ if pin == *tiob => channel.tiob_output(),
            _ => None,
        })
    }

    /// At another master clock the counters continue from their values.
    fn signal(&mut self, signal: Signal, context: &mut Context) {
        if let Signal::MasterClock(_) = signal {
            self.advance(context);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        (0..3).filter_map(|index| self.next_channel_event(index)).min()
    }

    fn interrupt(&self) -> bool {
        self.interrupts() != 0
    }

    fn interrupts(&self) -> u32 {
        (0..).zip(&self.channels).fold(0, |lines, (bit, channel)| lines | u32::from(channel.interrupt()) << bit)
    }

    fn reset(&mut self) {
        *self = Self::new(self.block);
    }
}

#[cfg(test)]
mod chaining_tests;
#[cfg(test)]
mod tests;
