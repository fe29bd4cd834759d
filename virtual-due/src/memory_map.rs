//! The chip's memories and their addresses (datasheet 7, "Product mapping", and 9.1).

use crate::cpu::Cpu;
use crate::engine::Engine;
use crate::memory::Region;
use sam3x_models::flash::{BANK, FLASH, FlashBank};
use sam3x_models::model::Memory;
use std::rc::Rc;

const ROM: u32 = 0x0010_0000;
const SRAM0: u32 = 0x2000_0000;
const SRAM0_BYTES: u32 = 0x1_0000;
const SRAM1: u32 = 0x2008_0000;
const NFC_SRAM: u32 = 0x2010_0000;

/// Parts of a new chip's ROM that programs rely on: the vector table of a boot loader that waits endlessly, and at
/// 0x0010_0008 the address of the In-Application Programming function, `status = iap(bank, command)`, which writes
/// EEFC_FCR and waits for FRDY (datasheet 18.4.5, as Thumb code).
const ROM_CODE: [(usize, &[u16]); 3] = [
    (0x00, &[0x1000, 0x2000, 0x0021, 0x0010, 0x0031, 0x0010]),
    // wait: wfi; b wait
    (0x20, &[0xBF30, 0xE7FD]),
    // ldr r2, =0x400E0A00; add r2, r2, r0, lsl #9; str r1, [r2, #4]; busy: ldr r0, [r2, #8]; lsls r3, r0, #31; beq busy;
    // bx lr
    (0x30, &[0x4A03, 0xEB02, 0x2240, 0x6051, 0x6890, 0x07C3, 0xD0FC, 0x4770, 0x0A00, 0x400E]),
];

/// The chip's memories.
#[derive(Debug)]
pub struct Memories {
    /// Two banks.
    pub flash: [Rc<Region>; 2],
    rom: Rc<Region>,
    sram0: Rc<Region>,
    sram1: Rc<Region>,
    nfc_sram: Rc<Region>,
    /// Pieces of memory that were written and not reported to the CPU yet: start and length.
    pub changed: Vec<(u32, u32)>,
    booted_from_flash: Option<bool>,
}

impl Memories {
    /// Erased flash, RAM of zeros.
    pub fn new() -> Self {
        let flash = [Region::new(BANK as usize), Region::new(BANK as usize)];
        for bank in &flash {
            bank.fill(0xFF);
        }
        let rom = Region::new(0x4000);
        for (offset, code) in ROM_CODE {
            let bytes: Vec<u8> = code.iter().flat_map(|halfword| halfword.to_le_bytes()).collect();
            rom.write(offset, &bytes);
        }
        Self {
            flash,
            rom,
            sram0: Region::new(SRAM0_BYTES as usize),
            sram1: Region::new(0x8000),
            nfc_sram: Region::new(0x1000),
            changed: Vec::new(),
            booted_from_flash: None,
        }
    }

    /// RAM after a loss of power: a pattern, as it is not defined.
    pub fn lose_ram(&mut self) {
        for (start, region) in [(SRAM0, &self.sram0), (SRAM1, &self.sram1), (NFC_SRAM, &self.nfc_sram)] {
            region.fill(0xA5);
            self.changed.push((start, region.len() as u32));
        }
    }

    /// Maps all but the boot memory into the CPU.
    pub fn map(&self, cpu: &mut Engine) {
        // Flash is read-only here: stores reach the EEFC's latch buffer.
        cpu.map(FLASH, &self.flash[0], false);
        cpu.map(FLASH + BANK, &self.flash[1], false);
        cpu.map(ROM, &self.rom, false);
        // SRAM0 repeats up to SRAM1, so that 0x2007_0000…0x2008_7FFF is 96 KiB in one piece (datasheet 9.1.1).
        for mirror in (SRAM0..SRAM1).step_by(SRAM0_BYTES as usize) {
            cpu.map(mirror, &self.sram0, true);
        }
        cpu.map(SRAM1, &self.sram1, true);
        cpu.map(NFC_SRAM, &self.nfc_sram, true);
    }

    /// Maps flash or ROM at address 0 after a reset (datasheet 9.1.4); returns stack pointer and entry.
    pub fn boot(&mut self, cpu: &mut Engine, from_flash: bool) -> (u32, u32) {
        if self.booted_from_flash.replace(from_flash) != Some(from_flash) {
            cpu.map(0, if from_flash { &self.flash[0] } else { &self.rom }, false);
            if from_flash {
                cpu.map(BANK, &self.flash[1], false);
            }
            cpu.changed(0, FLASH);
        }
        let first = if from_flash { &self.flash[0] } else { &self.rom };
        let mut vectors = [0; 8];
        first.read(0, &mut vectors);
        let [sp, entry] = [0, 4].map(|at| u32::from_le_bytes(vectors[at..at + 4].try_into().expect("four bytes")));
        (sp, entry)
    }

    /// Writes to any memory, flash too, as a debugger does; false outside memory.
    pub fn load(&mut self, address: u32, bytes: &[u8]) -> bool {
        let Some((region, offset, _)) = self.locate(address) else { return false };
        let done = region.write(offset, bytes);
        self.changed.push((address, bytes.len() as u32));
        done
    }

    fn locate(&self, address: u32) -> Option<(&Rc<Region>, usize, bool)> {
        let (region, base, writable) = match address {
            FLASH..0x000C_0000 => (&self.flash[0], FLASH, false),
            0x000C_0000..ROM => (&self.flash[1], FLASH + BANK, false),
            ROM..0x0010_4000 => (&self.rom, ROM, false),
            SRAM0..SRAM1 => (&self.sram0, address & !(SRAM0_BYTES - 1), true),
            SRAM1..0x2008_8000 => (&self.sram1, SRAM1, true),
            NFC_SRAM..0x2010_1000 => (&self.nfc_sram, NFC_SRAM, true),
            _ => return None,
        };
        Some((region, (address - base) as usize, writable))
    }
}

impl FlashBank for Region {
    fn read(&self, offset: usize, to: &mut [u8]) -> bool {
        self.read(offset, to)
    }

    fn write(&self, offset: usize, from: &[u8]) -> bool {
        self.write(offset, from)
    }

    fn fill(&self, byte: u8) {
        self.fill(byte);
    }
}

/// Runs `part` with each piece of a range that may cross from one memory into the next.
fn pieces(address: u32, length: usize, mut part: impl FnMut(u32, std::ops::Range<usize>) -> bool) -> bool {
    let mut done = 0;
    while done < length {
        let Some(at) = u32::try_from(done).ok().and_then(|done| address.checked_add(done)) else { return false };
        // All memories start and end on 4 KiB.
        let end = length.min(done + (0x1000 - (at as usize & 0xFFF)));
        if !part(at, done..end) {
            return false;
        }
        done = end;
    }
    true
}

impl Memory for Memories {
    fn read(&self, address: u32, bytes: &mut [u8]) -> bool {
        pieces(address, bytes.len(), |at, range| {
            self.locate(at).is_some_and(|(region, offset, _)| region.read(offset, &mut bytes[range]))
        })
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> bool {
        self.changed.push((address, bytes.len() as u32));
        pieces(address, bytes.len(), |at, range| {
            self.locate(at).is_some_and(|(region, offset, writable)| writable && region.write(offset, &bytes[range]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Memories, SRAM0};
    use sam3x_models::model::Memory;

    #[test]
    fn ram_is_one_piece_across_both_srams() {
        let mut memories = Memories::new();
        assert!(memories.write(0x2007_FFFE, &[1, 2, 3, 4]));
        let mut bytes = [0; 2];
        assert!(memories.read(SRAM0 + 0xFFFE, &mut bytes));
        assert_eq!(bytes, [1, 2]);
        assert!(memories.read(0x2008_0000, &mut bytes));
        assert_eq!(bytes, [3, 4]);
    }

    #[test]
    fn dma_does_not_write_flash_nor_beyond_ram() {
        let mut memories = Memories::new();
        assert!(!memories.write(0x0008_0000, &[0]));
        assert!(!memories.write(0x2008_8000, &[0]));
        assert!(!memories.write(0x1FFF_FFFF, &[0]));
    }
}
