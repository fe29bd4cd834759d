//! PMC: oscillators, PLLs, the master clock and the peripherals' clocks (datasheet 27 and 28).

use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral, Signal};
use crate::write_protection::WriteProtection;

const SCER: u32 = 0x00;
const SCDR: u32 = 0x04;
const SCSR: u32 = 0x08;
const PCER0: u32 = 0x10;
const PCDR0: u32 = 0x14;
const PCSR0: u32 = 0x18;
const UCKR: u32 = 0x1C;
const MOR: u32 = 0x20;
const MCFR: u32 = 0x24;
const PLLAR: u32 = 0x28;
const MCKR: u32 = 0x30;
const USB: u32 = 0x38;
const PCK0: u32 = 0x40;
const PCK2: u32 = 0x48;
const IER: u32 = 0x60;
const IDR: u32 = 0x64;
const SR: u32 = 0x68;
const IMR: u32 = 0x6C;
const FSMR: u32 = 0x70;
const FSPR: u32 = 0x74;
const FOCR: u32 = 0x78;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;
const PCER1: u32 = 0x100;
const PCDR1: u32 = 0x104;
const PCSR1: u32 = 0x108;
const PCR: u32 = 0x10C;

const MOSCXTS: u32 = 1;
const LOCKA: u32 = 1 << 1;
const MCKRDY: u32 = 1 << 3;
const LOCKU: u32 = 1 << 6;
const OSCSELS: u32 = 1 << 7;
const PCKRDY0: u32 = 1 << 8;
const MOSCSELS: u32 = 1 << 16;
const MOSCRCS: u32 = 1 << 17;

const MOSCXTEN: u32 = 1;
const MOSCXTBY: u32 = 1 << 1;
const MOSCRCEN: u32 = 1 << 3;
const MOSCSEL: u32 = 1 << 24;
const MOR_KEY: u32 = 0x37;
const UPLLEN: u32 = 1 << 16;
const MAINFRDY: u32 = 1 << 16;
const PCR_COMMAND: u32 = 1 << 12;

/// The Due's crystal.
const CRYSTAL_HZ: u32 = 12_000_000;
const SLOW_CLOCK_HZ: u32 = 32_768;
/// The fast RC oscillator by MOSCRCF: 4 MHz after reset (datasheet 27.5.1).
const FAST_RC_HZ: [u32; 4] = [4_000_000, 8_000_000, 12_000_000, 4_000_000];
const UPLL_HZ: u32 = 480_000_000;
const RESET_HZ: u32 = FAST_RC_HZ[0];
/// Highest frequency that flash and core are specified for, Hz (datasheet 45.4).
const HIGHEST_HZ: u32 = 84_000_000;
/// Identifiers 2…44; those below 8 belong to the system controller and always run (datasheet 28.14.4).
const GATED: u64 = 0x1FFF_FFFF_FF00;

/// Status bits of the parts that take time to become ready.
const SETTLING: [u32; 9] = [MOSCXTS, LOCKA, MCKRDY, LOCKU, OSCSELS, PCKRDY0, PCKRDY0 << 1, PCKRDY0 << 2, MOSCSELS];

/// The power management controller.
pub struct Pmc {
    system_clocks: u32,
    clocks: u64,
    utmi: u32,
    oscillator: u32,
    plla: u32,
    master: u32,
    usb: u32,
    programmable: [u32; 3],
    mask: u32,
    startup: [u32; 2],
    requested: u32,
    status: u32,
    /// Instant at which each bit of [`SETTLING`] is set.
    ready: [Option<Cycles>; 9],
    /// Instant at which MAINF has been counted.
    counted: Option<Cycles>,
    protection: WriteProtection,
    signalled_hz: u32,
}

impl Pmc {
    /// State after a reset: the chip runs from the fast RC oscillator.
    pub fn new() -> Self {
        Self {
            system_clocks: 1,
            clocks: 0,
            utmi: 0x1020_0800,
            oscillator: MOSCRCEN,
            plla: 0x0000_3F00,
            master: 1,
            usb: 0,
            programmable: [0; 3],
            mask: 0,
            startup: [0; 2],
            requested: 0,
            status: MCKRDY | MOSCSELS | MOSCRCS,
            ready: [None; 9],
            counted: Some(0),
            protection: WriteProtection::new(*b"PMC"),
            signalled_hz: RESET_HZ,
        }
    }

    /// Clears the bit until `then`, when it is set.
    fn become_ready_at(&mut self, bit: u32, then: Cycles) {
        self.status &= !bit;
        self.set_ready(bit, Some(then));
    }

    fn set_ready(&mut self, bit: u32, then: Option<Cycles>) {
        for (index, settling) in SETTLING.into_iter().enumerate() {
            if settling == bit {
                self.ready[index] = then;
            }
        }
    }

    fn stop(&mut self, bit: u32) {
        self.status &= !bit;
        self.set_ready(bit, None);
    }

    /// The main clock, 0 if the oscillator that is selected does not run.
    fn main_hz(&self) -> u32 {
        let crystal = self.oscillator & MOSCSEL != 0;
        match (crystal, self.oscillator & (MOSCXTEN | MOSCXTBY) != 0) {
            (true, true) => CRYSTAL_HZ,
            (true, false) => 0,
            (false, _) if self.oscillator & MOSCRCEN == 0 => 0,
            (false, _) => FAST_RC_HZ[(self.oscillator >> 4 & 3) as usize],
        }
    }

    fn plla_hz(&self) -> u32 {
        let (divider, multiplier) = (self.plla & 0xFF, self.plla >> 16 & 0x7FF);
        if divider == 0 || multiplier == 0 {
            return 0;
        }
        let hz = u64::from(self.main_hz()) * u64::from(multiplier + 1) / u64::from(divider);
        let halved = if self.master & 1 << 12 != 0 { hz / 2 } else { hz };
        u32::try_from(halved).unwrap_or(u32::MAX)
    }

    /// The clock that a CSS field selects (datasheet 28.14.10).
    fn source_hz(&self, css: u32) -> u32 {
        match css {
            0 => SLOW_CLOCK_HZ,
            1 => self.main_hz(),
            2 => self.plla_hz(),
            _ if self.utmi & UPLLEN == 0 => 0,
            _ if self.master & 1 << 13 != 0 => UPLL_HZ / 2,
            _ => UPLL_HZ,
        }
    }

    /// The master clock by the registers as they are.
    fn master_hz(&self) -> u32 {
        let divider = match self.master >> 4 & 7 {
            7 => 3,
            power => 1 << power,
        };
        self.source_hz(self.master & 3) / divider
    }

    /// Signals a change of the master clock to the chip.
    fn signal_master_clock(&mut self, context: &mut Context) {
        let hz = self.master_hz();
        if hz == 0 {
            context.warnings.warn_once("the master clock's source is off: a real chip stops here".to_owned());
            return;
        }
        let lock = match self.master & 3 {
            2 => LOCKA,
            3 => LOCKU,
            _ => 0,
        };
        if self.status & lock != lock {
            context.warnings.warn_once("the master clock was switched to a PLL that has not locked".to_owned());
        }
        if hz > HIGHEST_HZ {
            context.warnings.warn_once(format!("master clock of {hz} Hz: the chip is specified up to {HIGHEST_HZ} Hz"));
        }
        if hz != self.signalled_hz {
            self.signalled_hz = hz;
            context.signals.push(Signal::MasterClock(hz));
        }
    }

    fn set_clocks(&mut self, clocks: u64, context: &mut Context) {
        if clocks != self.clocks {
            self.clocks = clocks;
            context.signals.push(Signal::PeripheralClocks(clocks));
        }
    }

    fn write_oscillator(&mut self, value: u32, context: &mut Context) {
        if value >> 16 & 0xFF != MOR_KEY {
            return;
        }
        let before = std::mem::replace(&mut self.oscillator, value & !0x00FF_0000);
        if before & MOSCXTEN == 0 && value & MOSCXTEN != 0 {
            // MOSCXTST counts eight slow clocks (datasheet 28.14.7).
            self.become_ready_at(MOSCXTS, context.now + slow_clocks(8 * u64::from(value >> 8 & 0xFF)));
        } else if value & (MOSCXTEN | MOSCXTBY) == 0 {
            self.stop(MOSCXTS);
        }
        if (before ^ value) & MOSCSEL != 0 {
            self.become_ready_at(MOSCSELS, context.now + slow_clocks(3));
        }
        self.status = if value & MOSCRCEN != 0 { self.status | MOSCRCS } else { self.status & !MOSCRCS };
        // MAINF is counted over 16 slow clocks (datasheet 28.14.8).
        self.counted = Some(context.now + slow_clocks(16));
        self.signal_master_clock(context);
    }

    fn write_master(&mut self, value: u32, context: &mut Context) {
        let changed = std::mem::replace(&mut self.master, value & 0x3073) ^ self.master;
        if changed != 0 {
            self.signal_master_clock(context);
            // A few periods of both clocks.
            let slowest = self.signalled_hz.min(context.master_clock_hz).max(1);
            let wait = 8 * CYCLES_PER_SECOND / u64::from(slowest);
            self.become_ready_at(MCKRDY, context.now + wait);
        }
    }

    fn write_clock(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            SCER => self.system_clocks |= value & 0x720,
            SCDR => self.system_clocks &= !(value & 0x720),
            PCER0 => self.set_clocks(self.clocks | u64::from(value) & GATED, context),
            PCDR0 => self.set_clocks(self.clocks & !u64::from(value), context),
            PCER1 => self.set_clocks(self.clocks | u64::from(value) << 32 & GATED, context),
            PCDR1 => self.set_clocks(self.clocks & !(u64::from(value) << 32), context),
            UCKR => {
                self.utmi = value;
                if value & UPLLEN == 0 {
                    self.stop(LOCKU);
                } else {
                    self.become_ready_at(LOCKU, context.now + slow_clocks(8 * u64::from(value >> 20 & 0xF)));
                }
            }
            MOR => self.write_oscillator(value, context),
            PLLAR => {
                self.plla = value;
                if self.plla_hz() == 0 {
                    self.stop(LOCKA);
                } else {
                    self.become_ready_at(LOCKA, context.now + slow_clocks(u64::from(value >> 8 & 0x3F)));
                }
            }
            MCKR => self.write_master(value, context),
            USB => self.usb = value,
            PCK0..=PCK2 => {
                let index = (offset - PCK0) / 4;
                self.programmable[index as usize] = value;
                self.become_ready_at(PCKRDY0 << index, context.now + slow_clocks(1));
            }
            PCR => {
                self.requested = value & 0x3F;
                if value & PCR_COMMAND != 0 {
                    let bit = 1_u64 << (value & 0x3F) & GATED;
                    let on = value & 1 << 28 != 0;
                    self.set_clocks(if on { self.clocks | bit } else { self.clocks & !bit }, context);
                }
            }
            FSMR | FSPR => self.startup[(offset - FSMR) as usize / 4] = value,
            _ => context.warnings.unmodelled("PMC", offset),
        }
    }
}

/// A count of slow clocks, as a time.
fn slow_clocks(count: u64) -> Cycles {
    (count * CYCLES_PER_SECOND).div_ceil(u64::from(SLOW_CLOCK_HZ))
}

impl Peripheral for Pmc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            SCSR => self.system_clocks,
            PCSR0 => self.clocks as u32,
            PCSR1 => (self.clocks >> 32) as u32,
            UCKR => self.utmi,
            MOR => self.oscillator,
            MCFR if self.counted.is_some_and(|then| then <= context.now) => {
                MAINFRDY | (u64::from(self.main_hz()) * 16 / u64::from(SLOW_CLOCK_HZ)) as u32 & 0xFFFF
            }
            MCFR => 0,
            PLLAR => self.plla,
            MCKR => self.master,
            USB => self.usb,
            PCK0..=PCK2 => self.programmable[(offset - PCK0) as usize / 4],
            SR => self.status,
            IMR => self.mask,
            FSMR | FSPR => self.startup[(offset - FSMR) as usize / 4],
            PCR => self.requested | ((self.clocks >> self.requested & 1) as u32) << 28,
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            SCER | SCDR | PCER0 | PCDR0 | PCER1 | PCDR1 | IER | IDR | FOCR => 0,
            _ => {
                context.warnings.unmodelled("PMC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            // OSCSELS has no interrupt (datasheet 28.14.12).
            IER => self.mask |= value & !OSCSELS,
            IDR => self.mask &= !value,
            WPMR => self.protection.set_mode(value),
            FOCR => {}
            _ if self.protection.permits(offset) => self.write_clock(offset, value, context),
            _ => {}
        }
    }

    fn advance(&mut self, context: &mut Context) {
        for (bit, ready) in SETTLING.into_iter().zip(&mut self.ready) {
            if ready.is_some_and(|then| then <= context.now) {
                *ready = None;
                self.status |= bit;
            }
        }
    }

    fn signal(&mut self, signal: Signal, context: &mut Context) {
        match signal {
            Signal::Reset(_) => {
                self.counted = Some(context.now + slow_clocks(16));
                context.signals.push(Signal::MasterClock(RESET_HZ));
                context.signals.push(Signal::PeripheralClocks(0));
            }
            Signal::SlowCrystal(then) if then > context.now => self.become_ready_at(OSCSELS, then),
            Signal::SlowCrystal(_) => self.status |= OSCSELS,
            _ => {}
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.ready.iter().flatten().min().copied()
    }

    fn interrupt(&self) -> bool {
        self.status & self.mask != 0
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests;
