//! The ADC's registers (datasheet 43.7).

use super::{Adc, Pdc};
use crate::model::{Context, Signal};

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

const SWRST: u32 = 1 << 0;
const START: u32 = 1 << 1;

pub const DRDY: u32 = 1 << 24;
pub const GOVRE: u32 = 1 << 25;
pub const COMPE: u32 = 1 << 26;
pub const ENDRX: u32 = 1 << 27;
pub const RXBUFF: u32 = 1 << 28;

/// EMR.TAG.
pub const TAG: u32 = 1 << 24;

/// ADC_MR.
#[derive(Debug, Clone, Copy)]
pub struct Mode(pub u32);

impl Mode {
    /// The hardware trigger that TRGEN and TRGSEL select. Nothing drives the ADTRG pin.
    pub fn trigger(self) -> Option<Signal> {
        let selected = (self.0 >> 1) as u8 & 7;
        match selected {
            _ if self.0 & 1 == 0 => None,
            1..=3 => Some(Signal::Tioa(selected - 1)),
            4 | 5 => Some(Signal::PwmEvent(selected - 4)),
            _ => None,
        }
    }

    pub fn low_resolution(self) -> bool {
        self.0 & (1 << 4) != 0
    }

    /// The cell is off between sequences: SLEEP without FWUP.
    pub fn sleeps(self) -> bool {
        self.0 & (3 << 5) == 1 << 5
    }

    pub fn free_running(self) -> bool {
        self.0 & (1 << 7) != 0
    }

    pub fn user_sequence(self) -> bool {
        self.0 & (1 << 31) != 0
    }

    /// Master clock periods in a period of the ADC clock: (PRESCAL + 1) · 2.
    pub fn clock_divisor(self) -> u64 {
        (u64::from((self.0 >> 8) & 0xFF) + 1) * 2
    }

    /// ADC clocks that the cell takes to start.
    pub fn startup_clocks(self) -> u64 {
        const CLOCKS: [u64; 16] = [0, 8, 16, 24, 64, 80, 96, 112, 512, 576, 640, 704, 768, 832, 896, 960];
        CLOCKS[((self.0 >> 16) & 15) as usize]
    }

    /// ADC clocks before the sample is held: TRACKTIM + 1.
    pub fn tracking_clocks(self) -> u64 {
        u64::from((self.0 >> 24) & 15) + 1
    }

    /// ADC clocks from one conversion's start to the next one's: tracking, 12 bits, and a transfer of TRANSFER · 2 + 3; the
    /// cell itself takes no fewer than 20 (datasheet 45.7: 1 MS/s at 20 MHz).
    pub fn conversion_clocks(self) -> u64 {
        let transfer = u64::from((self.0 >> 28) & 3) * 2 + 3;
        (self.tracking_clocks() + 12 + transfer).max(20)
    }
}

/// EMR and CWR as the comparator sees them.
#[derive(Debug, Clone, Copy)]
pub struct CompareMode {
    pub extended: u32,
    pub window: u32,
}

impl Adc {
    pub(super) fn read_register(&mut self, offset: u32, context: &mut Context) -> u32 {
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
                context.report.unmodelled("ADC", offset);
                0
            }
        }
    }

    pub(super) fn write_register(&mut self, offset: u32, value: u32, context: &mut Context) {
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
            _ => context.report.unmodelled("ADC", offset),
        }
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
                    context.report.unmodelled("ADC", offset);
                }
                *(if offset == CGR { &mut self.gain } else { &mut self.offset }) = value;
            }
        }
    }
}
