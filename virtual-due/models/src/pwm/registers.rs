//! The PWM as a peripheral: access to its registers (datasheet 38.7), time, its pins.

use super::channel::{CHANNELS, channel_clock};
use super::{LOW_SIDE_LINES, Pwm};
use crate::model::{Context, Cycles, Peripheral, Pin, Side, Signal};
use crate::pdc::Pdc;

const CLK: u32 = 0x00;
const ENA: u32 = 0x04;
const DIS: u32 = 0x08;
const SR: u32 = 0x0C;
const IER1: u32 = 0x10;
const IDR1: u32 = 0x14;
const IMR1: u32 = 0x18;
const ISR1: u32 = 0x1C;
const SCM: u32 = 0x20;
const SCUC: u32 = 0x28;
const SCUP: u32 = 0x2C;
const SCUPUPD: u32 = 0x30;
const IER2: u32 = 0x34;
const IDR2: u32 = 0x38;
const IMR2: u32 = 0x3C;
const ISR2: u32 = 0x40;
const OOV: u32 = 0x44;
const OS: u32 = 0x48;
const OSS: u32 = 0x4C;
const OSC: u32 = 0x50;
const OSSUPD: u32 = 0x54;
const OSCUPD: u32 = 0x58;
const FMR: u32 = 0x5C;
const FSR: u32 = 0x60;
const FCR: u32 = 0x64;
const FPV: u32 = 0x68;
const FPE1: u32 = 0x6C;
const FPE2: u32 = 0x70;
const ELMR0: u32 = 0x7C;
const ELMR1: u32 = 0x80;
const SMMR: u32 = 0xB0;
const WPCR: u32 = 0xE4;
const WPSR: u32 = 0xE8;
const CMP: u32 = 0x130;
const CMP_END: u32 = 0x1B0;
const CHANNEL: u32 = 0x200;
const CHANNEL_END: u32 = 0x300;

const CMR: u32 = 0x00;
const CDTY: u32 = 0x04;
const CDTYUPD: u32 = 0x08;
const CPRD: u32 = 0x0C;
const CPRDUPD: u32 = 0x10;
const CCNT: u32 = 0x14;
const DT: u32 = 0x18;
const DTUPD: u32 = 0x1C;

const OVERRIDE_BITS: u32 = 0xFF_00FF;

const PIOC: u8 = 2;

impl Pwm {
    fn read_register(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            CLK => self.clock,
            SR => self.enabled(),
            IMR1 => self.channel_mask,
            ISR1 => std::mem::take(&mut self.channel_status),
            SCM => self.synchronous.mode,
            SCUC => self.synchronous.unlocked.into(),
            SCUP => self.synchronous.update_period_register(),
            IMR2 => self.update_mask,
            ISR2 => {
                let status = self.update_status();
                self.update_status = 0;
                status
            }
            OOV => self.override_values,
            OS => self.overridden,
            FMR => self.fault[0],
            FPV => self.fault[1],
            FPE1 => self.fault[2],
            FPE2 => self.fault[3],
            ELMR0 => self.event_lines[0],
            ELMR1 => self.event_lines[1],
            SMMR => self.stepper,
            WPSR => self.protection.take_status(),
            CMP..CMP_END => self.read_comparison(offset - CMP),
            CHANNEL..CHANNEL_END => self.read_channel(offset - CHANNEL, context),
            ENA | DIS | IER1 | IDR1 | SCUPUPD | IER2 | IDR2 | OSS | OSC | OSSUPD | OSCUPD | FSR | FCR | WPCR => 0,
            _ if Pdc::owns(offset) => self.pdc.read(offset),
            _ => {
                context.warnings.unmodelled("PWM", offset);
                0
            }
        }
    }

    fn read_comparison(&self, offset: u32) -> u32 {
        let unit = &self.comparisons[(offset / 0x10) as usize];
        match offset % 0x10 {
            0x0 => unit.value,
            0x8 => unit.mode_register(),
            _ => 0,
        }
    }

    fn read_channel(&self, offset: u32, context: &Context) -> u32 {
        let index = (offset / 0x20) as usize;
        let channel = &self.channels[index];
        match offset % 0x20 {
            CMR => channel.mode,
            CDTY => channel.duty,
            CPRD => channel.period,
            CCNT => self.channels[self.leader(index)].counter(self.timing(index), context.now),
            DT => channel.dead_time,
            _ => 0,
        }
    }

    fn write_register(&mut self, offset: u32, value: u32, context: &mut Context) {
        if !self.protection.permits(offset) {
            return;
        }
        match offset {
            CLK => {
                self.clock = value & 0x0FFF_0FFF;
                self.follow_clock(context);
            }
            ENA => self.enable(value, context),
            DIS => self.disable(value),
            IER1 => self.channel_mask |= value & OVERRIDE_BITS,
            IDR1 => self.channel_mask &= !value,
            SCM => self.synchronous.mode = value & 0xF3_00FF,
            SCUC => self.synchronous.unlocked |= value & 1 != 0,
            SCUP => self.synchronous.update_period = value & 15,
            SCUPUPD => self.synchronous.next_update_period = Some(value & 15),
            IER2 => self.update_mask |= value & 0xFF_FF0F,
            IDR2 => self.update_mask &= !value,
            OOV => self.override_values = value & OVERRIDE_BITS,
            OS => self.overridden = value & OVERRIDE_BITS,
            OSS => self.overridden |= value & OVERRIDE_BITS,
            OSC => self.overridden &= !value,
            OSSUPD => self.override_set |= value & OVERRIDE_BITS,
            OSCUPD => self.override_clear |= value & OVERRIDE_BITS,
            FMR | FPV | FPE1 | FPE2 | ELMR0 | ELMR1 | SMMR => self.store(offset, value, context),
            FCR | SR | IMR1 | ISR1 | IMR2 | ISR2 | FSR | WPSR => {}
            WPCR => self.protection.command(value),
            CMP..CMP_END => self.write_comparison(offset - CMP, value),
            CHANNEL..CHANNEL_END => self.write_channel(offset - CHANNEL, value, context),
            _ if Pdc::owns(offset) => self.pdc.write(offset, value),
            _ => context.warnings.unmodelled("PWM", offset),
        }
    }

    /// Stores registers that have no effect; values that would have one are reported.
    fn store(&mut self, offset: u32, value: u32, context: &mut Context) {
        let acts = matches!(offset, FPE1 | FPE2 | ELMR0 | ELMR1 | SMMR) && value != 0;
        if acts {
            context.warnings.unmodelled("PWM", offset);
        }
        let register = match offset {
            FMR => &mut self.fault[0],
            FPV => &mut self.fault[1],
            FPE1 => &mut self.fault[2],
            FPE2 => &mut self.fault[3],
            ELMR0 => &mut self.event_lines[0],
            ELMR1 => &mut self.event_lines[1],
            _ => &mut self.stepper,
        };
        *register = value;
    }

    fn write_comparison(&mut self, offset: u32, value: u32) {
        let unit = &mut self.comparisons[(offset / 0x10) as usize];
        match offset % 0x10 {
            0x0 => unit.value = value & 0x1FF_FFFF,
            0x4 => unit.next_value = Some(value & 0x1FF_FFFF),
            0x8 => unit.mode = value & 0xF_0FF1,
            _ => unit.next_mode = Some(value & 0xF_0FF1),
        }
    }

    fn write_channel(&mut self, offset: u32, value: u32, context: &Context) {
        let channel = &mut self.channels[(offset / 0x20) as usize];
        let count = value & 0xFF_FFFF;
        match offset % 0x20 {
            CMR => {
                channel.mode = value & 0x7_070F;
                self.follow_clock(context);
            }
            CDTY => channel.duty = count,
            CDTYUPD => channel.next_duty = Some(count),
            CPRD => channel.period = count,
            CPRDUPD => channel.next_period = Some(count),
            DT => channel.dead_time = value,
            DTUPD => channel.next_dead_time = Some(value),
            _ => {}
        }
    }

    fn follow_clock(&mut self, context: &Context) {
        for channel in &mut self.channels {
            let clock = channel_clock(channel.mode, self.clock, context.master_clock_hz);
            channel.follow_clock(clock, context.now);
        }
    }
}

impl Peripheral for Pwm {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        self.read_register(offset, context)
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        self.write_register(offset, value, context);
        self.report_duties(context.now, context);
    }

    fn advance(&mut self, context: &mut Context) {
        for index in 0..CHANNELS {
            if self.leader(index) == index {
                self.advance_channel(index, context);
            }
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        (0..CHANNELS)
            .filter(|index| self.leader(*index) == *index)
            .filter(|index| {
                self.acts_at_period_end(*index) || self.channel_mask & !self.channel_status & (1 << index) != 0
            })
            .filter_map(|index| self.channels[index].period_end(self.timing(index)))
            .min()
    }

    fn output(&self, pin: Pin, side: Side, now: Cycles) -> Option<bool> {
        let index = LOW_SIDE_LINES.iter().position(|line| *line == u32::from(pin.line))?;
        (pin.port == PIOC && side == Side::B).then(|| self.low_side_level(index, now))
    }

    fn next_output_edge(&self, pin: Pin, side: Side, now: Cycles) -> Option<Cycles> {
        let index = LOW_SIDE_LINES.iter().position(|line| *line == u32::from(pin.line))?;
        let is_output = pin.port == PIOC && side == Side::B;
        is_output.then(|| self.channels[index].next_edge(self.timing(index), now))?
    }

    fn interrupt(&self) -> bool {
        self.channel_status & self.channel_mask != 0 || self.update_status() & self.update_mask != 0
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        match signal {
            Signal::Pins { port: PIOC, b, .. } => self.pins = b,
            Signal::MasterClock(hz) => {
                for channel in &mut self.channels {
                    let clock = channel_clock(channel.mode, self.clock, hz);
                    channel.follow_clock(clock, context.now);
                }
            }
            _ => {}
        }
        self.report_duties(context.now, context);
    }

    /// The change is reported to the world with the next signal.
    fn reset(&mut self) {
        *self = Self { reported: self.reported, ..Self::new() };
    }
}
