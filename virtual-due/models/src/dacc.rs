//! DACC: the digital-to-analog converter (datasheet chapter 44): a FIFO of four values, two channels, and the PDC. Nothing is
//! on its outputs.

use crate::model::{Context, Cycles, Peripheral, Signal};
use crate::pdc::{Pdc, Width};
use crate::write_protection::WriteProtection;

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const CHER: u32 = 0x10;
const CHDR: u32 = 0x14;
const CHSR: u32 = 0x18;
const CDR: u32 = 0x20;
const IER: u32 = 0x24;
const IDR: u32 = 0x28;
const IMR: u32 = 0x2C;
const ISR: u32 = 0x30;
const ACR: u32 = 0x94;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

const SWRST: u32 = 1 << 0;
const TRGEN: u32 = 1 << 0;
const WORD: u32 = 1 << 4;
const MAXS: u32 = 1 << 21;

const TXRDY: u32 = 1 << 0;
const EOC: u32 = 1 << 1;
const ENDTX: u32 = 1 << 2;
const TXBUFE: u32 = 1 << 3;

const FIFO: usize = 4;

/// The converter.
#[derive(Debug, Clone)]
pub struct Dacc {
    mode: u32,
    enabled: u32,
    interrupt_mask: u32,
    analog_control: u32,
    /// Values that wait to be converted.
    waiting: usize,
    /// End of the conversion under way.
    converting: Option<Cycles>,
    ended: bool,
    pdc: Pdc,
    protection: WriteProtection,
}

impl Dacc {
    /// State after the chip's reset.
    pub fn new() -> Self {
        Self {
            mode: 0,
            enabled: 0,
            interrupt_mask: 0,
            analog_control: 0,
            waiting: 0,
            converting: None,
            ended: false,
            pdc: Pdc::new(),
            protection: WriteProtection::new(*b"DAC"),
        }
    }

    /// The signal that starts conversions; `None`: they follow each other freely. Nothing drives the pin DATRG.
    fn trigger(&self) -> Option<Signal> {
        match self.mode >> 1 & 7 {
            selected @ 1..=3 => Some(Signal::Tioa(selected as u8 - 1)),
            selected @ (4 | 5) => Some(Signal::PwmEvent(selected as u8 - 4)),
            _ => None,
        }
    }

    fn status(&self) -> u32 {
        let bits = [
            (TXRDY, self.enabled != 0 && self.waiting < FIFO),
            (EOC, self.ended),
            (ENDTX, self.pdc.end_of_transmit()),
            (TXBUFE, self.pdc.transmit_buffer_empty()),
        ];
        bits.iter().filter(|(_, set)| *set).fold(0, |status, (bit, _)| status | bit)
    }

    /// Begins the next conversion: 25 periods of MCK/2, 23 at the highest speed (datasheet 44.6.1 and 44.7.2).
    fn convert(&mut self, at: Cycles, context: &Context) {
        if self.converting.is_none() && self.enabled != 0 && self.waiting > 0 {
            self.waiting -= 1;
            let periods = if self.mode & MAXS == 0 { 25 } else { 23 };
            self.converting = Some(at + context.master_cycles(2 * periods));
        }
    }

    /// Fills the FIFO, begins what does not wait for a trigger, and fills what that left.
    fn serve(&mut self, at: Cycles, context: &mut Context) {
        self.fill(context);
        if self.mode & TRGEN == 0 {
            self.convert(at, context);
            self.fill(context);
        }
    }

    /// Fills the FIFO from the PDC.
    fn fill(&mut self, context: &mut Context) {
        let (width, values) = if self.mode & WORD == 0 { (Width::HalfWord, 1) } else { (Width::Word, 2) };
        while self.enabled != 0 && self.waiting + values <= FIFO {
            if self.pdc.transmit(width, context.memory).is_none() {
                break;
            }
            self.accept(values, context);
        }
    }

    fn accept(&mut self, values: usize, context: &mut Context) {
        context.warnings.warn_once("DACC: nothing is on its outputs: what it converts is lost".to_owned());
        self.waiting = (self.waiting + values).min(FIFO);
    }

    fn write_protected(&mut self, offset: u32, value: u32) {
        if self.protection.permits(offset) {
            match offset {
                MR => self.mode = value,
                CHER => self.enabled |= value & 3,
                CHDR => self.enabled &= !value,
                _ => self.analog_control = value & 0x30F,
            }
        }
    }
}

impl Peripheral for Dacc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MR => self.mode,
            CHSR => self.enabled,
            IMR => self.interrupt_mask,
            ISR => {
                let status = self.status();
                self.ended = false;
                status
            }
            ACR => self.analog_control,
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            _ if Pdc::owns(offset) => self.pdc.read(offset),
            CR | CHER | CHDR | CDR | IER | IDR => 0,
            _ => {
                context.warnings.unmodelled("DACC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR if value & SWRST != 0 => *self = Self { pdc: self.pdc.clone(), ..Self::new() },
            CDR => self.accept(if self.mode & WORD == 0 { 1 } else { 2 }, context),
            IER => self.interrupt_mask |= value & 0xF,
            IDR => self.interrupt_mask &= !value,
            MR | CHER | CHDR | ACR => self.write_protected(offset, value),
            WPMR => self.protection.set_mode(value),
            _ if Pdc::owns(offset) => self.pdc.write(offset, value),
            CR | CHSR | IMR | ISR | WPSR => {}
            _ => context.warnings.unmodelled("DACC", offset),
        }
        self.serve(context.now, context);
    }

    fn advance(&mut self, context: &mut Context) {
        while let Some(end) = self.converting.take_if(|end| *end <= context.now) {
            self.ended = true;
            self.serve(end, context);
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        if self.mode & TRGEN != 0 && self.trigger() == Some(signal) {
            self.convert(context.now, context);
            self.serve(context.now, context);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.converting.filter(|_| self.interrupt_mask != 0)
    }

    fn interrupt(&self) -> bool {
        self.status() & self.interrupt_mask != 0
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::{CDR, CHDR, CHER, CHSR, Dacc, ENDTX, EOC, IER, ISR, MR, TXRDY};
    use crate::model::{Peripheral, Signal};
    use crate::test_support::Bench;

    /// 25 periods of MCK/2.
    const CONVERSION: u64 = 50;

    fn channel_1() -> Bench<Dacc> {
        let mut bench = Bench::new(Dacc::new());
        bench.write(CHER, 2);
        bench
    }

    #[test]
    fn channels_are_shown_as_they_are_enabled() {
        let mut bench = channel_1();
        bench.write(CHER, 1);
        assert_eq!(bench.read(CHSR), 3);
        bench.write(CHDR, 2);
        assert_eq!(bench.read(CHSR), 1);
    }

    #[test]
    fn it_is_ready_only_with_a_channel() {
        let mut bench = Bench::new(Dacc::new());
        assert_eq!(bench.read(ISR) & TXRDY, 0);
        bench.write(CHER, 1);
        assert_eq!(bench.read(ISR) & TXRDY, TXRDY);
    }

    #[test]
    fn conversion_ends_after_its_time_and_is_shown_once() {
        let mut bench = channel_1();
        bench.write(CDR, 2048);
        bench.run(CONVERSION - 1);
        assert_eq!(bench.read(ISR) & EOC, 0);
        bench.run(1);
        assert_eq!(bench.read(ISR) & EOC, EOC);
        assert_eq!(bench.read(ISR) & EOC, 0);
        assert_eq!(bench.reports().len(), 1, "its output is lost");
    }

    #[test]
    fn four_values_wait_behind_the_one_that_is_converted() {
        let mut bench = channel_1();
        for value in 0..4 {
            bench.write(CDR, value);
            assert_eq!(bench.read(ISR) & TXRDY, TXRDY);
        }
        bench.write(CDR, 4);
        assert_eq!(bench.read(ISR) & TXRDY, 0);
        bench.run(CONVERSION);
        assert_eq!(bench.read(ISR) & TXRDY, TXRDY);
    }

    #[test]
    fn trigger_starts_one_conversion_each() {
        let mut bench = channel_1();
        // TIOA1.
        bench.write(MR, 1 | 2 << 1);
        bench.write(CDR, 1);
        bench.write(CDR, 2);
        bench.run(10 * CONVERSION);
        assert_eq!(bench.read(ISR) & EOC, 0);
        bench.signal(Signal::Tioa(0));
        bench.signal(Signal::Tioa(1));
        bench.run(10 * CONVERSION);
        assert_eq!(bench.read(ISR) & EOC, EOC);
        assert_eq!(bench.read(ISR) & EOC, 0, "the second waits");
    }

    #[test]
    fn pdc_feeds_it_and_its_end_interrupts() {
        let mut bench = channel_1();
        for (offset, value) in [(IER, ENDTX), (0x108, bench.memory.base), (0x10C, 10), (0x120, 1 << 8)] {
            bench.write(offset, value);
        }
        assert_eq!(bench.read(0x10C), 5, "one is converted and four wait");
        bench.run(5 * CONVERSION - 1);
        assert!(!bench.model.interrupt());
        bench.run(1);
        assert!(bench.model.interrupt());
    }
}
