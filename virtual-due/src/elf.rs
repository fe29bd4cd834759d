//! A firmware's ELF file: the contents of flash, and its symbols.

use object::elf::{EM_ARM, FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile32, FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol};
use sam3x_models::flash::{BANK, FLASH};
use std::collections::BTreeMap;

/// Reason why a file is not a firmware for this board.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ElfError {
    /// It is not an ELF file of 32 bits, or a damaged one.
    #[error("not a 32-bit ELF file ({0}); give the linker's output, not a .bin or .hex made from it")]
    NotElf(String),
    /// It is for another processor.
    #[error("an ELF file for another processor; build for ARM Cortex-M3 (thumbv7m-none-eabi, -mcpu=cortex-m3)")]
    NotArm,
    /// It was linked for other addresses.
    #[error(
        "{length} bytes are linked to {address:#010x}, outside flash (0x00080000 to 0x000fffff); link with the Due's memory map"
    )]
    Outside {
        /// Address of the first byte outside flash.
        address: u32,
        /// Number of bytes.
        length: u32,
    },
    /// It has nothing to load.
    #[error("there is no vector table at 0x00080000; give a linked firmware, not an object file or library")]
    Empty,
}

/// A firmware.
#[derive(Debug)]
pub struct Elf {
    /// Pieces of flash: address and bytes.
    pub pieces: Vec<(u32, Vec<u8>)>,
    symbols: BTreeMap<String, u32>,
}

impl Elf {
    /// Reads a file's bytes.
    ///
    /// # Errors
    ///
    /// [`ElfError`] if this is not a firmware for the board's flash.
    pub fn parse(bytes: &[u8]) -> Result<Self, ElfError> {
        let damaged = |error: object::Error| ElfError::NotElf(error.to_string());
        let file = ElfFile32::<Endianness>::parse(bytes).map_err(damaged)?;
        let endian = file.endian();
        if file.elf_header().e_machine(endian) != EM_ARM || !file.is_little_endian() {
            return Err(ElfError::NotArm);
        }
        let headers = FileHeader32::<Endianness>::parse(bytes)
            .and_then(|header| header.program_headers(endian, bytes))
            .map_err(damaged)?;
        let mut pieces = Vec::new();
        for header in headers.iter().filter(|header| header.p_type(endian) == PT_LOAD) {
            let data = header.data(endian, bytes).map_err(|()| ElfError::NotElf("a segment is cut off".to_owned()))?;
            if data.is_empty() {
                continue;
            }
            let (address, length) = (header.p_paddr(endian), data.len() as u32);
            if address < FLASH || u64::from(address) + u64::from(length) > u64::from(FLASH + 2 * BANK) {
                return Err(ElfError::Outside { address, length });
            }
            pieces.push((address, data.to_vec()));
        }
        if !pieces.iter().any(|(address, data)| *address == FLASH && data.len() >= 8) {
            return Err(ElfError::Empty);
        }
        let symbols = file
            .symbols()
            .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address() as u32)))
            .filter(|(name, _)| !name.is_empty() && !name.starts_with('$'))
            .collect();
        Ok(Self { pieces, symbols })
    }

    /// A symbol's value; a function's without the Thumb bit.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        let value = *self.symbols.get(name)?;
        let in_flash = (FLASH..FLASH + 2 * BANK).contains(&value);
        Some(if in_flash { value & !1 } else { value })
    }
}

#[cfg(test)]
mod tests {
    use super::{Elf, ElfError};

    #[test]
    fn a_binary_without_headers_is_refused() {
        assert!(matches!(Elf::parse(&[0; 100]), Err(ElfError::NotElf(_))));
        assert!(matches!(Elf::parse(&[]), Err(ElfError::NotElf(_))));
    }
}
