//! The ADC as a peripheral: access to its registers (datasheet 43.7), time, triggers.

use super::Adc;
use super::fields::{COMPE, DRDY, GOVRE, Mode};
use crate::model::{Context, Cycles, Peripheral, Signal};
use crate::pdc::Pdc;

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const SEQR1: u32 = 0x08;
const SEQR2: u32 = 0x0C;
const CHER: u32 = 0x10;
const CHDR: u32 = 0x14;
const CHSR: u32 = 0x18;
const LCDR: u32 = 0x20;
const IER: u32 = 0x24;
const IDR: u32 = 0x28;
const IMR: u32 = 0x2C;
const ISR: u32 = 0x30;
const OVER: u32 = 0x3C;
const EMR: u32 = 0x40;
const CWR: u32 = 0x44;
const CGR: u32 = 0x48;
const COR: u32 = 0x4C;
const CDR0: u32 = 0x50;
const CDR15: u32 = 0x8C;
const ACR: u32 = 0x94;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

/// The channel of the chip's temperature sensor.
const TEMPERATURE: u8 = 15;
/// The sensor is on.
const TSON: u32 = 1 << 4;
/// Its 0.8 V at 27 °C (datasheet 45.8), of a reference of 3.3 V.
const TEMPERATURE_COUNTS: u16 = 993;

const SWRST: u32 = 1 << 0;
const START: u32 = 1 << 1;

impl Adc {
    fn read_register(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MR => self.mode,
            SEQR1 => self.sequence_registers[0],
            SEQR2 => self.sequence_registers[1],
            CHSR => self.enabled.into(),
            LCDR => {
                self.status &= !DRDY;
                self.last
            }
            IMR => self.interrupt_mask,
            ISR => {
                let status = self.interrupt_status();
                self.status &= !(GOVRE | COMPE);
                status
            }
            OVER => std::mem::take(&mut self.overrun).into(),
            EMR => self.extended_mode,
            CWR => self.compare_window,
            CGR => self.gain,
            COR => self.offset,
            CDR0..=CDR15 => {
                let index = ((offset - CDR0) / 4) as usize & 15;
                self.ended &= !(1 << index);
                self.data[index].into()
            }
            ACR => self.analog_control,
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            _ if Pdc::owns(offset) => self.pdc.read(offset),
            // Write-only registers read as zero.
            CR | CHER | CHDR | IER | IDR => 0,
            _ => {
                context.warnings.unmodelled("ADC", offset);
                0
            }
        }
    }

    fn write_register(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => {
                if value & SWRST != 0 {
                    self.software_reset();
                }
                if value & START != 0 {
                    self.start(context.now, context);
                }
            }
            IER => self.interrupt_mask |= value & 0x1F00_FFFF,
            IDR => self.interrupt_mask &= !value,
            WPMR => self.protection.set_mode(value),
            MR | SEQR1 | SEQR2 | CHER | CHDR | EMR | CWR | CGR | COR | ACR => {
                if self.protection.permits(offset) {
                    self.write_protected(offset, value, context);
                }
            }
            _ if Pdc::owns(offset) => self.pdc.write(offset, value),
            CHSR | LCDR | IMR | ISR | OVER | WPSR | CDR0..=CDR15 => {}
            _ => context.warnings.unmodelled("ADC", offset),
        }
    }

    /// The chip is at 27 °C.
    fn temperature_counts(&self, context: &mut Context) -> u16 {
        if self.analog_control & TSON != 0 {
            return TEMPERATURE_COUNTS;
        }
        let text = "ADC: channel 15 is converted while the temperature sensor is off: set ADC_ACR.TSON";
        context.warnings.warn_once(text.to_owned());
        0
    }

    /// Gain, offset and differential input are stored but do not act.
    fn write_protected(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            MR => {
                self.mode = value;
                self.start_if_free_running(context);
            }
            SEQR1 => self.sequence_registers[0] = value,
            SEQR2 => self.sequence_registers[1] = value,
            CHER => {
                self.enabled |= value as u16;
                self.start_if_free_running(context);
            }
            CHDR => self.enabled &= !(value as u16),
            EMR => self.extended_mode = value & 0x0100_32F3,
            CWR => self.compare_window = value & 0x0FFF_0FFF,
            ACR => self.analog_control = value & 0x310,
            _ => {
                if value != 0 {
                    context.warnings.unmodelled("ADC", offset);
                }
                *(if offset == CGR { &mut self.gain } else { &mut self.offset }) = value;
            }
        }
    }
}

impl Peripheral for Adc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        self.read_register(offset, context)
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        self.write_register(offset, value, context);
        self.serve_pdc(context);
    }

    fn advance(&mut self, context: &mut Context) {
        while let Some(conversion) = self.sequence.take_completed(self.setup(), context) {
            let counts = match conversion.channel {
                TEMPERATURE => self.temperature_counts(context),
                channel => context.world.adc_counts(channel, conversion.sampled_at).min(0xFFF),
            };
            let tag = context.world.adc_tag(conversion.channel);
            self.complete(conversion.channel, (counts, tag), context);
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        if Mode(self.mode).trigger() == Some(signal) && !context.world.adc_is_stopped() {
            self.start(context.now, context);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.sequence.next_event()
    }

    fn interrupt(&self) -> bool {
        self.interrupt_status() & self.interrupt_mask != 0
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}
