//! USART0 to USART3 (datasheet chapter 35) as plain asynchronous ports. Other modes are reported and behave as this one.

use crate::model::{Context, Cycles, Peripheral};
use crate::serial::{BRGR, CR, ChannelMode, Format, MR, Serial};
use crate::write_protection::WriteProtection;

const RTOR: u32 = 0x24;
const TTGR: u32 = 0x28;
const FIDI: u32 = 0x40;
const NER: u32 = 0x44;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

const STTTO: u32 = 1 << 11;
const RETTO: u32 = 1 << 15;
const RTSEN: u32 = 1 << 18;
const RTSDIS: u32 = 1 << 19;
/// CR bits that mean something in the asynchronous mode.
const CR_BITS: u32 = 0x1FC | STTTO | RETTO | RTSEN | RTSDIS;

const TIMEOUT: u32 = 1 << 8;

const OVER: u32 = 1 << 19;
/// MR bits that select a mode this model does not have: USART_MODE, SYNC, MODE9, INVDATA, MAN.
const OTHER_MODES: u32 = 0xF | 1 << 8 | 1 << 17 | 1 << 23 | 1 << 29;

/// A USART.
#[derive(Debug, Clone)]
pub struct Usart {
    serial: Serial,
    protection: WriteProtection,
    mode: u32,
    baud_rate: u32,
    time_out: u32,
    time_guard: u8,
    fi_di_ratio: u32,
    timed_out: bool,
    times_out_at: Option<Cycles>,
}

impl Usart {
    /// USART0 … USART3 after the chip's reset, the world's serial ports 1 … 4.
    pub fn new(port: usize) -> Self {
        Self {
            serial: Serial::new(port),
            protection: WriteProtection::new(*b"USA"),
            mode: 0,
            baud_rate: 0,
            time_out: 0,
            time_guard: 0,
            fi_di_ratio: 0x174,
            timed_out: false,
            times_out_at: None,
        }
    }

    fn name(&self) -> &'static str {
        ["UART", "USART0", "USART1", "USART2", "USART3"].get(self.serial.port()).copied().unwrap_or("USART")
    }

    /// Eighths of a master clock period in a bit: baud rate = clock / (8 · (2 − OVER) · (CD + FP/8)) (datasheet 35.7.1.2).
    fn bit_eighths(&self) -> u64 {
        let cd = u64::from(self.baud_rate & 0xFFFF);
        let fp = u64::from((self.baud_rate >> 16) & 7);
        let samples = if self.mode & OVER == 0 { 16 } else { 8 };
        let prescaler = match (self.mode >> 4) & 3 {
            0 => 1,
            1 => 8,
            // SCK, which nothing drives.
            _ => 0,
        };
        if cd == 0 { 0 } else { samples * prescaler * (8 * cd + fp) }
    }

    fn bits(&self, count_in_halves: u64, context: &Context) -> Cycles {
        context.master_cycles(count_in_halves * self.bit_eighths() / 16)
    }

    fn format(&self, context: &Context) -> Format {
        let data_bits = 5 + u64::from((self.mode >> 6) & 3);
        let parity_bits = u64::from((self.mode >> 9) & 7 != 4);
        let stop_halves = match (self.mode >> 12) & 3 {
            0 => 2,
            1 => 3,
            _ => 4,
        };
        Format {
            byte_time: self.bits(2 * (1 + data_bits + parity_bits) + stop_halves, context),
            guard_time: self.bits(2 * u64::from(self.time_guard), context),
            mask: 0xFF >> (8 - data_bits),
            mode: ChannelMode::of(self.mode),
        }
    }

    /// The counter of RTOR runs from each byte on, and from RETTO on; STTTO waits for a byte (datasheet 35.7.3.11).
    fn watch_for_silence(&mut self, context: &Context) {
        if let Some(at) = self.serial.take_last_reception() {
            self.times_out_at = self.silence_ends(at, context);
        }
        if self.times_out_at.is_some_and(|at| at <= context.now) {
            self.times_out_at = None;
            self.timed_out = true;
        }
    }

    fn silence_ends(&self, from: Cycles, context: &Context) -> Option<Cycles> {
        let duration = self.bits(2 * u64::from(self.time_out), context);
        (duration != 0).then(|| from + duration)
    }

    fn control(&mut self, value: u32, context: &mut Context) {
        if value & STTTO != 0 {
            self.timed_out = false;
            self.times_out_at = None;
        }
        if value & RETTO != 0 {
            self.timed_out = false;
            self.times_out_at = self.silence_ends(context.now, context);
        }
        if value & !CR_BITS != 0 {
            context.report.unmodelled(self.name(), CR);
        }
    }

    fn more_status(&self) -> u32 {
        if self.timed_out { TIMEOUT } else { 0 }
    }

    fn write_protected(&mut self, offset: u32, value: u32, context: &mut Context) {
        if !self.protection.permits(offset) {
            return;
        }
        match offset {
            MR => {
                self.mode = value;
                let multidrop = (value >> 9) & 6 == 6;
                if value & OTHER_MODES != 0 || multidrop {
                    context.report.unmodelled(self.name(), MR);
                }
            }
            BRGR => self.baud_rate = value & 0x7_FFFF,
            RTOR => self.time_out = value & 0x1_FFFF,
            TTGR => self.time_guard = value as u8,
            _ => self.fi_di_ratio = value & 0x7FF,
        }
    }
}

impl Peripheral for Usart {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        let value = match offset {
            MR => self.mode,
            BRGR => self.baud_rate,
            RTOR => self.time_out,
            TTGR => self.time_guard.into(),
            FIDI => self.fi_di_ratio,
            NER => 0,
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            _ if Serial::owns(offset) => self.serial.read(offset, self.more_status()),
            _ => {
                context.report.unmodelled(self.name(), offset);
                0
            }
        };
        self.serial.serve(self.format(context), context);
        value
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => self.control(value, context),
            MR | BRGR | RTOR | TTGR | FIDI => self.write_protected(offset, value, context),
            WPMR => self.protection.set_mode(value),
            _ if Serial::owns(offset) => {}
            _ => context.report.unmodelled(self.name(), offset),
        }
        self.serial.write(offset, value, self.format(context), context);
        self.watch_for_silence(context);
    }

    fn advance(&mut self, context: &mut Context) {
        self.serial.advance(self.format(context), context);
        self.watch_for_silence(context);
    }

    fn next_event(&self) -> Option<Cycles> {
        [self.serial.next_event(), self.times_out_at].into_iter().flatten().min()
    }

    fn interrupt(&self) -> bool {
        (self.serial.status() | self.more_status()) & self.serial.interrupt_mask() != 0
    }

    fn reset(&mut self) {
        *self = Self::new(self.serial.port());
    }
}

#[cfg(test)]
mod tests {
    use super::{BRGR, CR, MR, RTOR, TTGR, Usart, WPMR, WPSR};
    use crate::test_support::Bench;

    const CSR: u32 = 0x14;
    const THR: u32 = 0x1C;

    /// 8 data bits, no parity, 84 MHz / (16 · 45.5) = 115 385 Bd: 728 cycles a bit.
    fn port() -> Bench<Usart> {
        let mut bench = Bench::new(Usart::new(2));
        bench.write(MR, 0x8C0);
        bench.write(BRGR, (4 << 16) + 45);
        bench.write(CR, 0x50);
        bench
    }

    #[test]
    fn fractional_divider_sets_the_byte_time() {
        let mut bench = port();
        bench.write(THR, 0x41);
        bench.run(10_000);
        assert_eq!(bench.world.sent, [(2, 0x41, 7280)]);
    }

    #[test]
    fn time_guard_separates_bytes() {
        let mut bench = port();
        bench.write(TTGR, 5);
        bench.write(THR, 1);
        bench.write(THR, 2);
        bench.run(40_000);
        assert_eq!(bench.world.sent, [(2, 1, 7280), (2, 2, 2 * 7280 + 5 * 728)]);
    }

    #[test]
    fn silence_after_a_byte_times_out_until_the_next_start_time_out() {
        let mut bench = port();
        bench.write(RTOR, 20);
        bench.world.arriving.push_back((7280, 1));
        bench.run(7280 + 20 * 728 - 1);
        assert_eq!(bench.read(CSR) & 0x100, 0);
        bench.run(1);
        assert_eq!(bench.read(CSR) & 0x100, 0x100);
        bench.write(CR, 1 << 11);
        bench.run(100_000);
        assert_eq!(bench.read(CSR) & 0x100, 0, "it waits for a byte");
    }

    #[test]
    fn write_protection_keeps_the_baud_rate() {
        let mut bench = port();
        bench.write(WPMR, 0x5553_4101);
        bench.write(BRGR, 1);
        assert_eq!(bench.read(BRGR), (4 << 16) + 45);
        assert_eq!(bench.read(WPSR), 0x2001);
    }

    #[test]
    fn other_modes_are_reported() {
        let mut bench = port();
        bench.write(MR, 0xE);
        assert_eq!(bench.report.take().len(), 1);
    }
}
