//! A firmware's ELF file: the contents of flash, and its symbols.

use firmware_image::{FLASH, ImageError, segments};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSymbol};
use std::collections::BTreeMap;

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
    /// [`ImageError`] if this is not a firmware for the board's flash.
    pub fn parse(bytes: &[u8]) -> Result<Self, ImageError> {
        let pieces = segments(bytes)?.into_iter().map(|(address, data)| (address, data.to_vec())).collect();
        let file = ElfFile32::<Endianness>::parse(bytes).map_err(|error| ImageError::NotElf(error.to_string()))?;
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
        Some(if FLASH.contains(&value) { value & !1 } else { value })
    }
}

#[cfg(test)]
mod tests {
    use super::{Elf, ImageError};

    #[test]
    fn a_binary_without_headers_is_refused() {
        assert!(matches!(Elf::parse(&[0; 100]), Err(ImageError::NotElf(_))));
        assert!(matches!(Elf::parse(&[]), Err(ImageError::NotElf(_))));
    }
}
