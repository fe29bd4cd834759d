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
