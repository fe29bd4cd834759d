//! Images of hand-made ELF files and plain files.

use firmware_image::{FLASH, ImageError, image, segments};

/// An initial stack pointer and a reset vector as the linker writes them, in the order of the bytes.
const VECTORS: [u8; 8] = [0x00, 0x80, 0x00, 0x20, 0xF9, 0x00, 0x08, 0x00];

/// An ELF file for ARM whose loadable segments are these: address in flash (physical address) and bytes.
fn elf(segments: &[(u32, &[u8])]) -> Vec<u8> {
    const HEADER: u32 = 52;
    const PROGRAM_HEADER: u32 = 32;
    let mut file = vec![0x7F, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    // Type: executable; machine: ARM; version.
    file.extend([2, 0, 40, 0, 1, 0, 0, 0]);
    for word in [FLASH.start + 0xF9, HEADER, 0, 0x0500_0000] {
        file.extend(word.to_le_bytes());
    }
    for half in [HEADER, PROGRAM_HEADER, segments.len() as u32, 0, 0, 0] {
        file.extend((half as u16).to_le_bytes());
    }
    let mut offset = HEADER + PROGRAM_HEADER * segments.len() as u32;
    for (address, data) in segments {
        let length = data.len() as u32;
        // Loadable; the address that it runs at is in SRAM, as that of initialised variables.
        for word in [1, offset, 0x2000_8000, *address, length, length, 6, 4] {
            file.extend(word.to_le_bytes());
        }
        offset += length;
    }
    file.extend(segments.iter().flat_map(|(_, data)| *data));
    file
}

#[test]
fn segments_are_placed_by_their_address_in_flash_and_gaps_are_erased() {
    let file = elf(&[(0x0008_000C, &[1, 2, 3]), (0x0008_0000, &VECTORS)]);
    let expected = [&VECTORS[..], &[0xFF; 4], &[1, 2, 3]].concat();
    assert_eq!(image(&file), Ok(expected));
}

#[test]
fn a_plain_file_is_its_own_image() {
    let file = [&VECTORS[..], &[9; 100]].concat();
    assert_eq!(image(&file), Ok(file.clone()));
}

#[test]
fn an_elf_that_is_linked_outside_flash_is_refused_with_its_address() {
    // An STM32's flash, one byte below the Due's, and one byte behind it.
    for address in [0x0800_0000, 0x0007_FFFF, 0x000F_FFFF] {
        let refused = image(&elf(&[(0x0008_0000, &VECTORS), (address, &[0, 0])]));
        assert_eq!(refused, Err(ImageError::Outside { address, length: 2 }));
    }
    assert!(image(&elf(&[(0x0008_0000, &VECTORS), (0x000F_FFFE, &[0, 0])])).is_ok_and(|image| image.len() == 0x8_0000));
}

#[test]
fn an_elf_for_another_processor_is_refused() {
    let mut file = elf(&[(0x0008_0000, &VECTORS)]);
    // EM_X86_64.
    file[18] = 62;
    assert_eq!(image(&file), Err(ImageError::NotArm));
}

#[test]
fn an_elf_that_is_cut_off_or_has_nothing_to_load_is_refused() {
    let file = elf(&[(0x0008_0000, &VECTORS)]);
    for length in [5, 60, file.len() - 1] {
        assert!(matches!(image(&file[..length]), Err(ImageError::NotElf(_))), "{length} bytes");
    }
    assert_eq!(image(&elf(&[])), Err(ImageError::Empty));
    assert_eq!(segments(&elf(&[(0x0008_0100, &VECTORS)])), Err(ImageError::Empty));
}

#[test]
fn a_plain_file_without_a_vector_table_of_this_chip_is_refused() {
    let intel_hex = b":020000040008F2\n:10000000008000";
    assert!(matches!(image(intel_hex), Err(ImageError::Vectors { .. })));
    // An even reset vector is no address of Thumb code; 0x0800_00F9 is not in this flash.
    for (at, byte) in [(4, 0xF8), (7, 0x08), (3, 0x10)] {
        let mut file = VECTORS;
        file[at] = byte;
        assert!(matches!(image(&file), Err(ImageError::Vectors { .. })), "byte {at}");
    }
    assert_eq!(image(&VECTORS[..7]), Err(ImageError::Empty));
    assert_eq!(image(&[]), Err(ImageError::Empty));
}

#[test]
fn a_plain_file_longer_than_the_flash_is_refused() {
    let mut file = VECTORS.to_vec();
    file.resize(FLASH.len(), 0);
    assert!(image(&file).is_ok());
    file.push(0);
    assert_eq!(image(&file), Err(ImageError::TooLong(FLASH.len() + 1)));
}
