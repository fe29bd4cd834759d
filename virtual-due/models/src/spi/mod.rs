//! SPI0 and SPI1 as a master (datasheet chapter 32): transfers take their time, MISO is MOSI in local loop-back, and reads as
//! ones without, since nothing is on the wires.
//!
//! Slave mode and mode faults are not modelled. The SAM3X's SPI has no PDC.

use crate::model::{Context, Cycles, Peripheral};
use crate::write_protection::WriteProtection;

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const RDR: u32 = 0x08;
const TDR: u32 = 0x0C;
const SR: u32 = 0x10;
const IER: u32 = 0x14;
const IDR: u32 = 0x18;
const IMR: u32 = 0x1C;
const CSR0: u32 = 0x30;
const CSR3: u32 = 0x3C;
const WPMR: u32 = 0xE4;
const WPSR: u32 = 0xE8;

const SPIEN: u32 = 1 << 0;
const SPIDIS: u32 = 1 << 1;
const SWRST: u32 = 1 << 7;

const MSTR: u32 = 1 << 0;
const PS: u32 = 1 << 1;
const PCSDEC: u32 = 1 << 2;
const WDRBT: u32 = 1 << 5;
const LLB: u32 = 1 << 7;

const CSAAT: u32 = 1 << 3;

const RDRF: u32 = 1 << 0;
const TDRE: u32 = 1 << 1;
const OVRES: u32 = 1 << 3;
const TXEMPTY: u32 = 1 << 9;
const SPIENS: u32 = 1 << 16;
/// RDRF, TDRE, MODF, OVRES, NSSR, TXEMPTY and UNDES.
const INTERRUPTS: u32 = 0x70F;

/// A transfer under way.
#[derive(Debug, Clone, Copy)]
struct Transfer {
    received: u16,
    /// PCS of the transfer.
    select: u32,
    ends_at: Cycles,
}

/// SPI0 or SPI1.
#[derive(Debug)]
pub struct Spi {
    name: &'static str,
    enabled: bool,
    mode: u32,
    chip_selects: [u32; 4],
    interrupt_mask: u32,
    /// TDR, while it waits for the shift register.
    holding: Option<u32>,
    transfer: Option<Transfer>,
    /// The chip select that is still active, by its PCS.
    selected: Option<u32>,
    /// No transfer begins before.
    free_at: Cycles,
    received: u32,
    /// RDRF and OVRES.
    latched: u32,
    protection: WriteProtection,
}

impl Spi {
    /// State after the chip's reset.
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            enabled: false,
            mode: 0,
            chip_selects: [0; 4],
            interrupt_mask: 0,
            holding: None,
            transfer: None,
            selected: None,
            free_at: 0,
            received: 0,
            latched: 0,
            protection: WriteProtection::new(*b"SPI"),
        }
    }

    fn control(&mut self, value: u32) {
        if value & SWRST != 0 {
            self.reset();
        }
        // A transfer under way is finished (datasheet 32.8.1).
        if value & SPIDIS != 0 {
            self.enabled = false;
            self.holding = None;
        } else if value & SPIEN != 0 {
            self.enabled = true;
        }
    }

    fn status(&self) -> u32 {
        let is_empty = self.holding.is_none() && self.transfer.is_none();
        let bits = [
            (TDRE, self.enabled && self.holding.is_none()),
            (TXEMPTY, self.enabled && is_empty),
            (SPIENS, self.enabled),
        ];
        bits.iter().filter(|(_, set)| *set).fold(self.latched, |status, (bit, _)| status | bit)
    }

    /// PCS of a datum: TDR's with a variable peripheral, else MR's.
    fn select_of(&self, datum: u32) -> u32 {
        (if self.mode & PS != 0 { datum } else { self.mode }) >> 16 & 0xF
    }

    /// CSR of a PCS: that of the lowest line that is low, or of the decoder's four outputs (datasheet 32.7.3.6).
    fn chip_select(&self, select: u32) -> u32 {
        let index = if self.mode & PCSDEC != 0 { select / 4 } else { select.trailing_ones().min(3) };
        self.chip_selects[index as usize]
    }

    /// Moves TDR to the shift register, if that is free, from `at` on.
    fn load(&mut self, at: Cycles, context: &mut Context) {
        let waits = self.transfer.is_some() || self.mode & WDRBT != 0 && self.latched & RDRF != 0;
        let Some(datum) = self.holding.take_if(|_| !waits) else { return };
        let select = self.select_of(datum);
        let settings = self.chip_select(select);
        let (baud, before) = (u64::from(settings >> 8 & 0xFF), u64::from(settings >> 16 & 0xFF));
        if baud == 0 {
            context.warnings.warn_once(format!("{}: a transfer at SCBR = 0, which the datasheet forbids", self.name));
        }
        let bits = u64::from(settings >> 4 & 0xF).min(8) + 8;
        // DLYBS from a chip select that becomes active; half a bit if it is 0 (datasheet 32.8.9).
        let delay = match (self.selected == Some(select), before) {
            (true, _) => 0,
            (false, 0) => baud / 2,
            (false, before) => before,
        };
        let ones = ((1_u32 << bits) - 1) as u16;
        let begins_at = at.max(self.free_at);
        self.transfer = Some(Transfer {
            received: if self.mode & LLB != 0 { datum as u16 & ones } else { ones },
            select,
            ends_at: begins_at + context.master_cycles(delay + bits * baud).max(1),
        });
        self.selected = Some(select);
    }

    fn complete(&mut self, transfer: Transfer, context: &Context) {
        let settings = self.chip_select(transfer.select);
        self.transfer = None;
        self.received = u32::from(transfer.received) | transfer.select << 16;
        // The new datum replaces one that was not read (datasheet 32.7.3).
        self.latched |= if self.latched & RDRF != 0 { OVRES } else { RDRF };
        // DLYBCT counts 32 clocks (datasheet 32.8.9).
        self.free_at = transfer.ends_at + context.master_cycles(32 * u64::from(settings >> 24));
        if self.holding.is_none() && settings & CSAAT == 0 {
            self.selected = None;
        }
    }

    fn transmit(&mut self, value: u32, context: &mut Context) {
        if !self.enabled {
            return;
        }
        if self.mode & MSTR == 0 {
            context.warnings.warn_once(format!("{}: slave mode is not modelled", self.name));
            return;
        }
        if self.mode & LLB == 0 {
            context.warnings.warn_once(format!("{}: nothing is on its wires: it receives ones", self.name));
        }
        self.holding = Some(value);
        self.load(context.now, context);
    }

    fn write_protected(&mut self, offset: u32, value: u32) {
        if self.protection.permits(offset) {
            match offset {
                MR => self.mode = value,
                _ => self.chip_selects[(offset - CSR0) as usize / 4] = value,
            }
        }
    }
}

impl Peripheral for Spi {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MR => self.mode,
            RDR => {
                self.latched &= !RDRF;
                self.load(context.now, context);
                self.received
            }
            SR => {
                let status = self.status();
                self.latched &= !OVRES;
                status
            }
            IMR => self.interrupt_mask,
            CSR0..=CSR3 => self.chip_selects[(offset - CSR0) as usize / 4],
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            CR | TDR | IER | IDR => 0,
            _ => {
                context.warnings.unmodelled(self.name, offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => self.control(value),
            TDR => self.transmit(value, context),
            IER => self.interrupt_mask |= value & INTERRUPTS,
            IDR => self.interrupt_mask &= !value,
            MR | CSR0..=CSR3 => self.write_protected(offset, value),
            WPMR => self.protection.set_mode(value),
            RDR | SR | IMR | WPSR => {}
            _ => context.warnings.unmodelled(self.name, offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        while let Some(transfer) = self.transfer.filter(|transfer| transfer.ends_at <= context.now) {
            self.complete(transfer, context);
            self.load(transfer.ends_at, context);
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        self.transfer.filter(|_| self.interrupt_mask != 0).map(|transfer| transfer.ends_at)
    }

    fn interrupt(&self) -> bool {
        self.status() & self.interrupt_mask != 0
    }

    fn reset(&mut self) {
        *self = Self::new(self.name);
    }
}

#[cfg(test)]
mod tests;
