//! EEFC: a bank of flash and its controller (datasheet 18).
//!
//! The model also receives stores to its bank, at the bank's own addresses: they fill the latch buffer.

use crate::flash::{BANK, FLASH, FlashBank};
use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral, Signal};
use std::rc::Rc;

const FMR: u32 = 0x00;
const FCR: u32 = 0x04;
const FSR: u32 = 0x08;
const FRR: u32 = 0x0C;
const KEY: u32 = 0x5A;

const FRDY: u32 = 1;
const FCMDE: u32 = 1 << 1;
const FLOCKE: u32 = 1 << 2;

const PAGE: u32 = 256;
const PAGES: u32 = BANK / PAGE;
/// Lock regions of 16 KiB.
const LOCKS: u32 = 16;
const PAGES_IN_LOCK: u32 = PAGES / LOCKS;
const LATCH: usize = PAGE as usize;

/// Highest master clock, Hz, for 0, 1, … wait states (datasheet 45.11, as the vendor's CMSIS gives it).
const WAIT_STATES_HZ: [u32; 5] = [22_500_000, 34_000_000, 53_000_000, 78_000_000, u32::MAX];

const MILLISECOND: Cycles = CYCLES_PER_SECOND / 1000;
/// Times of datasheet 45.11, typical: write a page, erase and write, erase all, set or clear a bit.
const WRITE: Cycles = 23 * MILLISECOND / 10;
const ERASE_WRITE: Cycles = 46 * MILLISECOND / 10;
const ERASE_ALL: Cycles = 15 * MILLISECOND;
const BIT: Cycles = 15 * MILLISECOND / 10;
const READ: Cycles = 100;

/// GPNVM bits of a new board: boot from flash.
const GPNVM_NEW: u32 = 0b010;
const GPNVM_BITS: u32 = 3;

/// A bank's 128-bit unique identifier: chip lot and number would be here.
const UNIQUE: [u8; 16] = *b"virtual Due 0001";

/// A flash controller and its bank.
pub struct Eefc {
    bank: usize,
    base: u32,
    flash: Rc<dyn FlashBank>,
    mode: u32,
    status: u32,
    /// End of the command under way.
    ready: Option<Cycles>,
    results: Vec<u32>,
    latch: [u8; LATCH],
    locks: u32,
    gpnvm: u32,
    /// Bytes of the bank that the unique identifier replaces while it is being read.
    hidden: Option<[u8; 16]>,
}

impl Eefc {
    /// The controller of bank 0 or 1, whose bytes are `flash`, at `base`.
    pub fn new(bank: usize, flash: Rc<dyn FlashBank>, base: u32) -> Self {
        Self {
            bank,
            base,
            flash,
            mode: 0,
            status: FRDY,
            ready: None,
            results: Vec::new(),
            latch: [0xFF; LATCH],
            locks: 0,
            gpnvm: GPNVM_NEW,
            hidden: None,
        }
    }

    fn name(&self) -> &'static str {
        ["EEFC0", "EEFC1"][self.bank]
    }

    fn begin(&mut self, takes: Cycles, context: &Context) {
        self.status &= !FRDY;
        self.ready = Some(context.now + takes);
    }

    fn command(&mut self, value: u32, context: &mut Context) {
        // FSR's errors are those of the last command (datasheet 18.5.3).
        self.status &= !(FCMDE | FLOCKE);
        self.results.clear();
        let argument = value >> 8 & 0xFFFF;
        if value >> 24 != KEY || !self.execute(value & 0xFF, argument, context) {
            self.status |= FCMDE;
        }
    }

    /// Executes a command; false if it does not exist (datasheet 18.4.3).
    fn execute(&mut self, command: u32, argument: u32, context: &mut Context) -> bool {
        if self.hidden.is_some() && command != 0x0F {
            return false;
        }
        match command {
            0x00 => {
                // Descriptor: identifier, size, page size, planes, bytes of the plane, lock bits, bytes of each.
                self.results = vec![0x000F_0740, BANK, PAGE, 1, BANK, LOCKS];
                self.results.extend([BANK / LOCKS; LOCKS as usize]);
                self.results.reverse();
            }
            0x01..=0x04 => return self.program(argument, command & 1 == 0, command > 2, context),
            0x05 if self.locks != 0 => self.status |= FLOCKE,
            0x05 => {
                self.flash.fill(0xFF);
                context.signals.push(Signal::Flash(self.base, BANK));
                self.begin(ERASE_ALL, context);
            }
            0x08 | 0x09 if argument < PAGES => {
                let bit = 1 << (argument / PAGES_IN_LOCK);
                self.locks = if command == 0x08 { self.locks | bit } else { self.locks & !bit };
                self.begin(BIT, context);
            }
            0x0A => self.results = vec![self.locks],
            0x0B..=0x0D if self.bank == 1 => return false,
            0x0B | 0x0C if argument < GPNVM_BITS => {
                let bit = 1 << argument;
                self.gpnvm = if command == 0x0B { self.gpnvm | bit } else { self.gpnvm & !bit };
                context.signals.push(Signal::BootFlash(self.gpnvm & 2 != 0));
                self.begin(BIT, context);
            }
            0x0D => self.results = vec![self.gpnvm],
            0x0E => self.show_unique(context),
            0x0F => self.hide_unique(context),
            _ => return false,
        }
        true
    }

    /// WP, WPL, EWP, EWPL: programs the latch buffer into a page. Without erasing, bits can only become 0.
    fn program(&mut self, page: u32, lock: bool, erase: bool, context: &mut Context) -> bool {
        if page >= PAGES {
            return false;
        }
        let region = 1 << (page / PAGES_IN_LOCK);
        if self.locks & region != 0 {
            self.status |= FLOCKE;
            return true;
        }
        let offset = (page * PAGE) as usize;
        let mut bytes = [0xFF; LATCH];
        if !erase {
            self.flash.read(offset, &mut bytes);
        }
        for (byte, latched) in bytes.iter_mut().zip(self.latch) {
            *byte &= latched;
        }
        self.flash.write(offset, &bytes);
        self.latch = [0xFF; LATCH];
        if lock {
            self.locks |= region;
        }
        if (self.mode >> 8 & 0xF) < 6 {
            let text = "flash is programmed with fewer than 6 wait states: a real chip may write garbage".to_owned();
            context.report.warn_once(text);
        }
        context.signals.push(Signal::Flash(self.base + page * PAGE, PAGE));
        self.begin(if erase { ERASE_WRITE } else { WRITE }, context);
        true
    }

    /// STUI: the bank's first bytes read as the unique identifier, and FRDY falls, until SPUI (datasheet 18.4.3.8).
    fn show_unique(&mut self, context: &mut Context) {
        let mut hidden = [0; 16];
        self.flash.read(0, &mut hidden);
        self.flash.write(0, &UNIQUE);
        self.hidden = Some(hidden);
        self.status &= !FRDY;
        context.signals.push(Signal::Flash(self.base, PAGE));
    }

    fn hide_unique(&mut self, context: &mut Context) {
        if let Some(hidden) = self.hidden.take() {
            self.flash.write(0, &hidden);
            context.signals.push(Signal::Flash(self.base, PAGE));
            self.begin(READ, context);
        }
    }

    fn check_wait_states(&self, hz: u32, context: &mut Context) {
        let states = (self.mode >> 8 & 0xF).min(4) as usize;
        if hz > WAIT_STATES_HZ[states] {
            let name = self.name();
            context
                .report
                .warn_once(format!("{name}: {states} wait states at {hz} Hz: a real chip reads garbage from flash"));
        }
    }
}

impl Peripheral for Eefc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            FMR => self.mode,
            FSR => {
                let status = self.status;
                self.status &= !(FCMDE | FLOCKE);
                status
            }
            FRR => self.results.pop().unwrap_or(0),
            FCR => 0,
            _ => {
                context.report.unmodelled(self.name(), offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            FMR => {
                self.mode = value & 0x0101_0F01;
                self.check_wait_states(context.master_clock_hz, context);
            }
            FCR if self.ready.is_none() => self.command(value, context),
            FCR => context.report.warn_once(format!("{}: a command while another is under way", self.name())),
            FLASH.. => {
                let at = (offset & (PAGE - 1) & !3) as usize;
                self.latch[at..at + 4].copy_from_slice(&value.to_le_bytes());
            }
            _ => context.report.unmodelled(self.name(), offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        if self.ready.is_some_and(|then| then <= context.now) {
            self.ready = None;
            self.status |= FRDY;
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        match signal {
            Signal::Reset(_) => self.hide_unique(context),
            Signal::MasterClock(hz) => self.check_wait_states(hz, context),
            _ => {}
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.ready
    }

    fn interrupt(&self) -> bool {
        self.mode & self.status & FRDY != 0
    }

    fn reset(&mut self) {
        self.mode = 0;
        self.status = FRDY;
        self.ready = None;
        self.results.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::{BANK, ERASE_WRITE, Eefc, FCMDE, FCR, FLASH, FLOCKE, FMR, FRDY, FRR, FSR, PAGE, UNIQUE};
    use crate::model::{Peripheral, Signal};
    use crate::test_support::{Bench, FlashBytes};
    use std::rc::Rc;

    fn bank() -> Bench<Eefc> {
        let flash = Rc::new(FlashBytes::erased(BANK as usize));
        let mut bench = Bench::new(Eefc::new(0, flash, FLASH));
        bench.write(FMR, 6 << 8);
        bench
    }

    fn command(bench: &mut Bench<Eefc>, command: u32, argument: u32) -> u32 {
        bench.write(FCR, 0x5A00_0000 | argument << 8 | command);
        bench.run(ERASE_WRITE * 4);
        bench.read(FSR)
    }

    fn page(bench: &Bench<Eefc>, page: u32) -> [u8; 4] {
        let mut bytes = [0; 4];
        bench.model.flash.read((page * PAGE) as usize, &mut bytes);
        bytes
    }

    #[test]
    fn a_page_is_erased_and_written_from_the_latch_buffer() {
        let mut bench = bank();
        bench.write(FLASH + 7 * PAGE, 0x1234_5678);
        bench.write(FCR, 0x5A00_0703);
        assert_eq!(bench.read(FSR) & FRDY, 0);
        bench.run(ERASE_WRITE);
        assert_eq!(bench.read(FSR), FRDY);
        assert_eq!(page(&bench, 7), [0x78, 0x56, 0x34, 0x12]);
        assert_eq!(bench.signalled(), [Signal::Flash(FLASH + 7 * PAGE, PAGE)]);
        // The latch buffer is erased after use.
        command(&mut bench, 3, 7);
        assert_eq!(page(&bench, 7), [0xFF; 4]);
    }

    #[test]
    fn write_without_erase_only_clears_bits() {
        let mut bench = bank();
        bench.write(FLASH, 0x0000_00F0);
        command(&mut bench, 1, 0);
        bench.write(FLASH, 0xFFFF_FF3C);
        command(&mut bench, 1, 0);
        assert_eq!(page(&bench, 0), [0x30, 0, 0, 0]);
    }

    #[test]
    fn a_locked_page_is_kept_and_sets_flocke() {
        let mut bench = bank();
        command(&mut bench, 8, 64);
        assert_eq!(command(&mut bench, 10, 0), FRDY);
        assert_eq!(bench.read(FRR), 2);
        bench.write(FLASH + 64 * PAGE, 0);
        assert_eq!(command(&mut bench, 3, 64), FRDY | FLOCKE);
        assert_eq!(page(&bench, 64), [0xFF; 4]);
    }

    #[test]
    fn a_wrong_key_or_command_is_an_error() {
        let mut bench = bank();
        bench.write(FCR, 0x0000_0003);
        assert_eq!(bench.read(FSR), FRDY | FCMDE);
        assert_eq!(bench.read(FSR), FRDY);
        assert_eq!(command(&mut bench, 0x33, 0), FRDY | FCMDE);
    }

    #[test]
    fn the_unique_identifier_shows_between_start_and_stop() {
        let mut bench = bank();
        bench.write(FCR, 0x5A00_000E);
        assert_eq!(bench.read(FSR) & FRDY, 0);
        assert_eq!(page(&bench, 0), UNIQUE[..4]);
        assert_eq!(command(&mut bench, 0x0F, 0), FRDY);
        assert_eq!(page(&bench, 0), [0xFF; 4]);
    }

    #[test]
    fn frdy_interrupts_when_a_command_ends() {
        let mut bench = bank();
        bench.write(FCR, 0x5A00_0003);
        bench.write(FMR, 6 << 8 | 1);
        assert!(!bench.model.interrupt());
        bench.run(ERASE_WRITE);
        assert!(bench.model.interrupt());
    }
}
