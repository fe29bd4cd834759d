//! The ADC (datasheet chapter 43): 16 channels, converted one after the other on a trigger.

mod fields;
mod registers;
mod sequence;
mod threshold;

use crate::model::{Context, Cycles};
use crate::pdc::{Pdc, Width};
use crate::write_protection::WriteProtection;
use fields::{COMPE, CompareMode, DRDY, ENDRX, GOVRE, Mode, RXBUFF, TAG};
use sequence::{Sequence, Setup};
use threshold::Threshold;

/// The converter.
#[derive(Debug, Clone)]
pub struct Adc {
    mode: u32,
    sequence_registers: [u32; 2],
    enabled: u16,
    interrupt_mask: u32,
    /// EOC bits of ADC_ISR.
    ended: u16,
    overrun: u16,
    /// DRDY, GOVRE and COMPE of ADC_ISR.
    status: u32,
    extended_mode: u32,
    compare_window: u32,
    gain: u32,
    offset: u32,
    analog_control: u32,
    last: u32,
    data: [u16; 16],
    threshold: Threshold,
    sequence: Sequence,
    pdc: Pdc,
    protection: WriteProtection,
}

impl Default for Adc {
    fn default() -> Self {
        Self::new()
    }
}

impl Adc {
    /// State after the chip's reset.
    pub fn new() -> Self {
        Self {
            mode: 0,
            sequence_registers: [0; 2],
            enabled: 0,
            interrupt_mask: 0,
            ended: 0,
            overrun: 0,
            status: 0,
            extended_mode: 0,
            compare_window: 0,
            gain: 0,
            offset: 0,
            analog_control: 0x100,
            last: 0,
            data: [0; 16],
            threshold: Threshold::default(),
            sequence: Sequence::default(),
            pdc: Pdc::new(),
            protection: WriteProtection::new(*b"ADC"),
        }
    }

    fn setup(&self) -> Setup {
        Setup { mode: Mode(self.mode), enabled: self.enabled, user_sequence: self.sequence_registers }
    }

    fn start(&mut self, at: Cycles, context: &Context) {
        self.sequence.start(at, self.setup(), context);
    }

    /// FREERUN never waits for a trigger.
    fn start_if_free_running(&mut self, context: &Context) {
        if Mode(self.mode).free_running() {
            self.start(context.now, context);
        }
    }

    /// ADC_ISR without clearing anything.
    fn interrupt_status(&self) -> u32 {
        let end_of_receive = if self.pdc.end_of_receive() { ENDRX } else { 0 };
        let buffer_full = if self.pdc.receive_buffer_full() { RXBUFF } else { 0 };
        u32::from(self.ended) | self.status | end_of_receive | buffer_full
    }

    /// A conversion of `channel` is complete (datasheet 43.6.4).
    fn complete(&mut self, channel: u8, (counts, tag): (u16, u8), context: &mut Context) {
        let result = if Mode(self.mode).low_resolution() { counts >> 2 } else { counts };
        let index = usize::from(channel & 15);
        let bit = 1 << index;
        self.overrun |= self.ended & bit;
        self.ended |= bit;
        if self.status & DRDY != 0 {
            self.status |= GOVRE;
        }
        self.status |= DRDY;
        self.data[index] = result;
        let tag = if self.extended_mode & TAG != 0 { u32::from(tag) << 12 } else { 0 };
        self.last = u32::from(result) | tag;
        let compare = CompareMode { extended: self.extended_mode, window: self.compare_window };
        if self.threshold.passes(channel, result, compare) {
            self.status |= COMPE;
        }
        self.serve_pdc(context);
    }

    /// The PDC reads LCDR while DRDY is set, 16 bits at a time (datasheet 43.6.11).
    fn serve_pdc(&mut self, context: &mut Context) {
        if self.status & DRDY != 0 && self.pdc.receive(self.last, Width::HalfWord, context.memory) {
            self.status &= !DRDY;
        }
    }

    /// SWRST: resets the ADC, but not its PDC.
    fn software_reset(&mut self) {
        *self = Self { pdc: self.pdc.clone(), ..Self::new() };
    }
}

#[cfg(test)]
mod tests;
