//! A firmware's ELF file: the contents of flash, and its symbols.

use firmware_image::{FLASH, ImageError, segments};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSymbol, SymbolKind};
use std::collections::BTreeMap;

/// A firmware.
#[derive(Debug)]
pub struct Elf {
    /// Pieces of flash: address and bytes.
    pub pieces: Vec<(u32, Vec<u8>)>,
    symbols: BTreeMap<String, u32>,
    /// Functions by their first address: length in bytes and name.
    functions: BTreeMap<u32, (u32, String)>,
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
        let functions = file
            .symbols()
            .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
            .filter_map(|symbol| {
                Some((symbol.address() as u32 & !1, (symbol.size() as u32, symbol.name().ok()?.to_owned())))
            })
            .collect();
        Ok(Self { pieces, symbols, functions })
    }

    /// Name of the function that has an instruction at `pc`, as it is written in the program.
    pub fn function(&self, pc: u32) -> Option<String> {
        let (start, (length, name)) = self.functions.range(..=pc).next_back()?;
        (pc - start < *length).then(|| demangled(name))
    }

    /// A symbol's value; a function's without the Thumb bit.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        let value = *self.symbols.get(name)?;
        Some(if FLASH.contains(&value) { value & !1 } else { value })
    }
}

/// The name of a symbol of Rust, C or C++.
fn demangled(symbol: &str) -> String {
    if let Ok(name) = rustc_demangle::try_demangle(symbol) {
        return format!("{name:#}");
    }
    let name = cpp_demangle::Symbol::new(symbol).ok().and_then(|name| name.demangle().ok());
    name.unwrap_or_else(|| symbol.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{Elf, ImageError, demangled};

    #[test]
    fn functions_have_the_names_of_the_program() {
        assert_eq!(demangled("SysTick_Handler"), "SysTick_Handler");
        assert_eq!(demangled("_ZN9UARTClass5writeEh"), "UARTClass::write(unsigned char)");
        assert_eq!(demangled("_ZN8firmware5board4init17h0123456789abcdefE"), "firmware::board::init");
    }

    #[test]
    fn a_binary_without_headers_is_refused() {
        assert!(matches!(Elf::parse(&[0; 100]), Err(ImageError::NotElf(_))));
        assert!(matches!(Elf::parse(&[]), Err(ImageError::NotElf(_))));
    }
}
