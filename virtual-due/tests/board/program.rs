//! Programs of a few instructions, as a linker would give them.

use rig_twin::Scenario;
use virtual_due::{CYCLES_PER_SECOND, Machine, WiredRig};

pub const FLASH: u32 = 0x0008_0000;
pub const ENTRY: u32 = FLASH + 0x40;
pub const MILLISECOND: u64 = CYCLES_PER_SECOND / 1000;
pub const SPIN: u16 = 0xE7FE;
pub const WFI: u16 = 0xBF30;

/// An ELF file with these bytes at an address.
pub fn elf(address: u32, bytes: &[u8]) -> Vec<u8> {
    let mut file = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
    let halves = |file: &mut Vec<u8>, values: &[u16]| values.iter().for_each(|value| file.extend(value.to_le_bytes()));
    let words = |file: &mut Vec<u8>, values: &[u32]| values.iter().for_each(|value| file.extend(value.to_le_bytes()));
    // An executable for ARM, one program header behind this one.
    halves(&mut file, &[2, 40]);
    words(&mut file, &[1, ENTRY, 52, 0, 0x0500_0200]);
    halves(&mut file, &[52, 32, 1, 40, 0, 0]);
    let length = bytes.len() as u32;
    words(&mut file, &[1, 84, address, address, length, length, 5, 4]);
    file.extend(bytes);
    file
}

/// An ELF file with the symbol of a function, its address and its length in bytes.
pub fn with_function(mut file: Vec<u8>, name: &str, address: u32, length: u32) -> Vec<u8> {
    let names = format!("\0{name}\0");
    let symbols = file.len() as u32;
    // The null symbol, and a global function (STT_FUNC) in an absolute section, with its Thumb bit.
    file.extend([0; 16]);
    file.extend([1, address | 1, length].into_iter().flat_map(u32::to_le_bytes));
    file.extend([0x12, 0, 0xF1, 0xFF]);
    file.extend(names.as_bytes());
    file.resize(file.len().next_multiple_of(4), 0);
    let sections = file.len() as u32;
    let strings = symbols + 32;
    let length = names.len() as u32;
    // Name, type, flags, address, offset, size, link, info, alignment, entry size: null, .symtab, .strtab.
    let headers = [[0; 10], [0, 2, 0, 0, symbols, 32, 2, 1, 4, 16], [0, 3, 0, 0, strings, length, 0, 0, 1, 0]];
    file.extend(headers.concat().into_iter().flat_map(u32::to_le_bytes));
    file[32..36].copy_from_slice(&sections.to_le_bytes());
    // Section headers: size, count, index of their names.
    file[46..52].copy_from_slice(&[40, 0, 3, 0, 2, 0]);
    file
}

/// A firmware of this program, which begins at [`ENTRY`] with the stack below 0x2001_0000; every fault enters
/// `program[fault]`.
pub fn firmware(program: &[u16], fault: usize) -> Vec<u8> {
    let handler = ENTRY + 2 * fault as u32 + 1;
    let mut words = vec![0x2001_0000, ENTRY + 1, handler, handler];
    words.resize(0x10, 0);
    let mut bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
    bytes.extend(program.iter().flat_map(|halfword| halfword.to_le_bytes()));
    elf(FLASH, &bytes)
}

/// A board with this [`firmware`].
pub fn board(program: &[u16], fault: usize) -> Machine<WiredRig> {
    Machine::new(&firmware(program, fault), WiredRig::new(Scenario::FreeSwing, 1)).expect("a firmware for the Due")
}

/// ldr r0, =address (kept at the end of the program, `at` words behind the entry).
pub const fn load_r0(at: u16) -> u16 {
    0x4800 | at
}
