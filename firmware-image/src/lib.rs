//! The image of a firmware in the Arduino Due's flash, from its ELF file or from a plain file.
//!
//! A plain file holds the bytes of the flash from its first address on, as `objcopy -O binary` makes it and bossac writes it.

use std::ops::Range;

use object::Endianness;
use object::elf::{ELFMAG, EM_ARM, FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

/// Addresses of the flash: both banks of the ATSAM3X8E, 256 KiB each.
pub const FLASH: Range<u32> = 0x0008_0000..0x0010_0000;

/// Addresses of SRAM0 and SRAM1, in which a stack begins: the address behind the last is one, as a push goes below it.
const SRAM: Range<u32> = 0x2000_0000..0x2008_8001;

/// Byte of erased flash.
const ERASED: u8 = 0xFF;

/// Reason why a file is not a firmware for this flash.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// It is not an ELF file of 32 bits, or a damaged one.
    #[error("not a 32-bit ELF file ({0}); give the linker's output")]
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
    /// A plain file is longer than the flash.
    #[error("{0} bytes, more than the flash of 524288 bytes")]
    TooLong(usize),
    /// The first words are no vector table of this chip.
    #[error(
        "begins with the words {stack:#010x} and {reset:#010x}, which are not a stack pointer and a reset vector of the Due"
    )]
    Vectors {
        /// First word: the initial stack pointer.
        stack: u32,
        /// Second word: the reset vector.
        reset: u32,
    },
}

/// The loadable segments of an ELF file: address in flash and bytes.
///
/// # Errors
/// [`ImageError`] if one of them is outside flash, or none begins it.
pub fn segments(elf: &[u8]) -> Result<Vec<(u32, &[u8])>, ImageError> {
    let damaged = |error: object::Error| ImageError::NotElf(error.to_string());
    let header = FileHeader32::<Endianness>::parse(elf).map_err(damaged)?;
    let endian = header.endian().map_err(damaged)?;
    if header.e_machine(endian) != EM_ARM || endian != Endianness::Little {
        return Err(ImageError::NotArm);
    }
    let mut segments = Vec::new();
    for segment in header.program_headers(endian, elf).map_err(damaged)? {
        if segment.p_type(endian) != PT_LOAD {
            continue;
        }
        let data = segment.data(endian, elf).map_err(|()| ImageError::NotElf("a segment is cut off".to_owned()))?;
        if data.is_empty() {
            continue;
        }
        let (address, length) = (segment.p_paddr(endian), data.len() as u32);
        if address < FLASH.start || u64::from(address) + u64::from(length) > u64::from(FLASH.end) {
            return Err(ImageError::Outside { address, length });
        }
        segments.push((address, data));
    }
    if segments.iter().any(|(address, data)| *address == FLASH.start && data.len() >= 8) {
        Ok(segments)
    } else {
        Err(ImageError::Empty)
    }
}

/// True for an ELF file, false for a plain one.
#[must_use]
pub fn is_elf(file: &[u8]) -> bool {
    file.starts_with(&ELFMAG)
}

/// The plain image of a file, which is an ELF file or plain: the bytes of the flash from its first address to the last that is
/// used; gaps are 0xFF.
///
/// # Errors
/// [`ImageError`] if it is not a firmware for this flash.
pub fn image(file: &[u8]) -> Result<Vec<u8>, ImageError> {
    let image = if is_elf(file) { joined(&segments(file)?) } else { file.to_vec() };
    if image.len() > FLASH.len() {
        return Err(ImageError::TooLong(image.len()));
    }
    let word = |offset: usize| {
        let bytes = image.get(offset..offset + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    };
    let (Some(stack), Some(reset)) = (word(0), word(4)) else { return Err(ImageError::Empty) };
    let is_thumb = reset % 2 == 1;
    if SRAM.contains(&stack) && FLASH.contains(&reset) && is_thumb {
        Ok(image)
    } else {
        Err(ImageError::Vectors { stack, reset })
    }
}

fn joined(segments: &[(u32, &[u8])]) -> Vec<u8> {
    let mut image = Vec::new();
    for (address, data) in segments {
        let start = (address - FLASH.start) as usize;
        let end = start + data.len();
        if image.len() < end {
            image.resize(end, ERASED);
        }
        image[start..end].copy_from_slice(data);
    }
    image
}
