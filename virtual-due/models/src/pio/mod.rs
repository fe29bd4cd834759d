//! PIO: a controller of 32 pins (datasheet 31).

mod interrupts;

use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral, Pin, Side, Signal};
use crate::write_protection::WriteProtection;
use interrupts::Interrupts;

/// A group of three registers: set, clear, and status.
const PER: u32 = 0x00;
const OER: u32 = 0x10;
const IFER: u32 = 0x20;
const SODR: u32 = 0x30;
const ODSR: u32 = 0x38;
const PDSR: u32 = 0x3C;
const ISR: u32 = 0x4C;
const MDER: u32 = 0x50;
const PUDR: u32 = 0x60;
const PUER: u32 = 0x64;
const PUSR: u32 = 0x68;
const ABSR: u32 = 0x70;
const SCIFSR: u32 = 0x80;
const DIFSR: u32 = 0x84;
const IFDGSR: u32 = 0x88;
const SCDR: u32 = 0x8C;
const OWER: u32 = 0xA0;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

/// Period at which pins are sampled while an interrupt is enabled: the world does not signal changes of a level.
const POLL: Cycles = CYCLES_PER_SECOND / 10_000;
/// PMC identifier of PIOA; those of the others follow.
const FIRST_IDENTIFIER: u8 = 11;

/// A set/clear pair of registers and what it sets.
#[derive(Debug, Clone, Copy)]
struct Bits(u32);

impl Bits {
    /// Writes the register `which` of the group: 0 sets, 4 clears.
    fn write(&mut self, which: u32, value: u32) {
        match which {
            0 => self.0 |= value,
            4 => self.0 &= !value,
            _ => {}
        }
    }
}

/// A controller, PIOA…PIOD as 0…3.
pub struct Pio {
    port: u8,
    /// PSR: the pin is the controller's; else a peripheral's.
    enabled: Bits,
    outputs: Bits,
    filters: Bits,
    levels: u32,
    open_drain: Bits,
    /// PUSR: a set bit is a pull-up that is off.
    pull_up_off: u32,
    peripheral_b: u32,
    slow_filters: u32,
    slow_divider: u32,
    written_at_once: Bits,
    interrupts: Interrupts,
    protection: WriteProtection,
    /// Registers are written without the controller's clock, but the pins are sampled by it (datasheet 31.4.2).
    clock_runs: bool,
    /// Lines that peripherals drive, and their levels.
    outputs_of_peripherals: (u32, u32),
    /// Levels of the pins when last sampled: PDSR.
    pins: u32,
    next_sample: Cycles,
    /// Driven lines and their levels, as last reported to the world.
    reported: (u32, u32),
    reported_peripherals: Option<(u32, u32)>,
}

impl Pio {
    /// State after a reset: all pins are inputs of the controller with pull-ups.
    pub fn new(port: u8) -> Self {
        Self {
            port,
            enabled: Bits(u32::MAX),
            outputs: Bits(0),
            filters: Bits(0),
            levels: 0,
            open_drain: Bits(0),
            pull_up_off: 0,
            peripheral_b: 0,
            slow_filters: 0,
            slow_divider: 0,
            written_at_once: Bits(0),
            interrupts: Interrupts::default(),
            protection: WriteProtection::new(*b"PIO"),
            clock_runs: false,
            outputs_of_peripherals: (0, 0),
            pins: u32::MAX,
            next_sample: 0,
            reported: (0, 0),
            reported_peripherals: None,
        }
    }

    fn name(&self) -> &'static str {
        ["PIOA", "PIOB", "PIOC", "PIOD"][usize::from(self.port)]
    }

    /// The lines that the controller drives: an open-drain one only when it is low.
    fn driven(&self) -> u32 {
        self.enabled.0 & self.outputs.0 & !(self.open_drain.0 & self.levels)
    }

    /// Reports changes of the pins' drivers to world and chip.
    fn report_pins(&mut self, context: &mut Context) {
        let now = (self.driven(), self.levels);
        let before = std::mem::replace(&mut self.reported, now);
        let mut changed = (now.0 ^ before.0) | now.0 & (now.1 ^ before.1);
        while changed != 0 {
            let line = changed.trailing_zeros();
            let level = (now.0 >> line & 1 != 0).then_some(now.1 >> line & 1 != 0);
            context.world.drive(Pin { port: self.port, line: line as u8 }, level, context.now);
            changed &= changed - 1;
        }
        let peripherals = (!self.enabled.0 & !self.peripheral_b, !self.enabled.0 & self.peripheral_b);
        if self.reported_peripherals.replace(peripherals) != Some(peripherals) {
            let (a, b) = peripherals;
            context.signals.push(Signal::Pins { port: self.port, a, b });
        }
    }

    /// Samples the levels of all pins.
    fn sample_pins(&mut self, context: &mut Context) {
        let driven = self.driven();
        let (given, levels) = self.outputs_of_peripherals;
        let given = given & !self.enabled.0;
        let mut pins = driven & self.levels | given & levels;
        let mut others = !(driven | given);
        while others != 0 {
            let line = others.trailing_zeros();
            let pulled_up = self.pull_up_off >> line & 1 == 0;
            let outside = context.world.level(Pin { port: self.port, line: line as u8 }, context.now);
            pins |= u32::from(outside.unwrap_or(pulled_up)) << line;
            others &= others - 1;
        }
        let before = std::mem::replace(&mut self.pins, pins);
        self.interrupts.update(before, pins);
    }

    /// PDSR. Without the clock it shows the levels at the time at which the clock was switched off (datasheet 31.5.8).
    fn read_pins(&mut self, context: &mut Context) -> u32 {
        if self.clock_runs {
            self.sample_pins(context);
        } else {
            context.warnings.warn_once(format!(
                "{}: PDSR is read while the PIO's clock is off: it does not follow the pins; enable the clock in PMC_PCER0",
                self.name()
            ));
        }
        self.pins
    }

    /// True if pins have to be sampled for an interrupt.
    fn watches_pins(&self) -> bool {
        self.clock_runs && self.interrupts.enabled()
    }

    /// True if write protection covers the register (datasheet 31.5.13).
    fn is_protected(offset: u32) -> bool {
        matches!(offset, 0x00..=0x14 | 0x20..=0x24 | 0x50..=0x64 | ABSR | 0xA0..=0xA4)
    }

    fn write_register(&mut self, offset: u32, value: u32, context: &mut Context) {
        let which = offset & 0xC;
        match offset & !0xF {
            PER if which < 8 => self.enabled.write(which, value),
            OER if which < 8 => self.outputs.write(which, value),
            IFER if which < 8 => self.filters.write(which, value),
            MDER if which < 8 => self.open_drain.write(which, value),
            OWER if which < 8 => self.written_at_once.write(which, value),
            _ => match offset {
                SODR => self.levels |= value,
                0x34 => self.levels &= !value,
                ODSR => self.levels = self.levels & !self.written_at_once.0 | value & self.written_at_once.0,
                PUDR => self.pull_up_off |= value,
                PUER => self.pull_up_off &= !value,
                ABSR => self.peripheral_b = value,
                SCIFSR => self.slow_filters &= !value,
                DIFSR => self.slow_filters |= value,
                SCDR => self.slow_divider = value & 0x3FFF,
                _ if self.interrupts.write(offset, value) => {}
                // Read-only registers of the groups.
                0x08 | 0x18 | 0x28 | PDSR | ISR | 0x58 | PUSR | IFDGSR | 0xA8 => {}
                _ => context.warnings.unmodelled(self.name(), offset),
            },
        }
    }
}

impl Peripheral for Pio {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            0x08 => self.enabled.0,
            0x18 => self.outputs.0,
            0x28 => self.filters.0,
            ODSR => self.levels,
            PDSR => self.read_pins(context),
            ISR => self.interrupts.take_status(),
            0x58 => self.open_drain.0,
            PUSR => self.pull_up_off,
            ABSR => self.peripheral_b,
            IFDGSR => self.slow_filters,
            SCDR => self.slow_divider,
            0xA8 => self.written_at_once.0,
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            _ => match self.interrupts.read(offset) {
                Some(value) => value,
                // The write-only halves of the pairs.
                None if offset < 0xAC => 0,
                None => {
                    context.warnings.unmodelled(self.name(), offset);
                    0
                }
            },
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        if offset == WPMR {
            self.protection.set_mode(value);
        } else if !Self::is_protected(offset) || self.protection.permits(offset) {
            self.write_register(offset, value, context);
            self.report_pins(context);
            if self.watches_pins() {
                self.sample_pins(context);
            }
        }
    }

    fn advance(&mut self, context: &mut Context) {
        if self.watches_pins() && self.next_sample <= context.now {
            self.sample_pins(context);
            // On a fixed grid, independent of samples taken for other reasons.
            self.next_sample = (context.now / POLL + 1) * POLL;
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        match signal {
            Signal::Reset(_) => {
                self.reported_peripherals = None;
                self.report_pins(context);
            }
            Signal::PeripheralClocks(clocks) => {
                self.clock_runs = clocks >> (FIRST_IDENTIFIER + self.port) & 1 != 0;
                self.sample_pins(context);
            }
            Signal::WiresMoved if self.watches_pins() => self.sample_pins(context),
            Signal::Outputs { driven, levels } => self.outputs_of_peripherals = (driven, levels),
            _ => {}
        }
    }

    /// The level at which the controller itself drives a pin.
    fn output(&self, pin: Pin, _side: Side, _now: Cycles) -> Option<bool> {
        let is_driven = pin.port == self.port && self.driven() >> pin.line & 1 != 0;
        is_driven.then_some(self.levels >> pin.line & 1 != 0)
    }

    fn next_event(&self) -> Option<Cycles> {
        self.watches_pins().then_some(self.next_sample)
    }

    fn interrupt(&self) -> bool {
        self.interrupts.raised()
    }

    fn reset(&mut self) {
        // The difference is reported to the world afterwards.
        *self = Self { reported: self.reported, ..Self::new(self.port) };
    }
}

#[cfg(test)]
mod tests;
