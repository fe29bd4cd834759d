//! Boards with the firmware and a table in their flash.

use proprio_link::table::StoredTable;
use virtual_due::model::World;
use virtual_due::{FLASH_BYTES, Machine};

use crate::build::firmware;
use crate::replay::table;

/// First byte of the flash.
const FLASH: usize = 0x8_0000;

/// The reference arm's table as the board stores it.
///
/// # Panics
/// Never: the reference table is valid.
#[must_use]
pub fn stored_table() -> StoredTable {
    let file = table();
    StoredTable::new(&file, file.to_toml().as_bytes()).expect("the reference table can be stored")
}

/// Content of a flash with a table; the store is at the end of the flash.
///
/// # Panics
/// If the table does not fit.
#[must_use]
pub fn flash_with(table: &StoredTable) -> Vec<u8> {
    let store = table.store().expect("it fits");
    let mut flash = vec![0xFF; FLASH_BYTES - store.len()];
    flash.extend(store);
    flash
}

/// Addresses of the bytes of the reference arm's table in the flash: the slot's header, the image and the packed file.
///
/// # Panics
/// Never: the reference table fits.
#[must_use]
pub fn table_addresses() -> Vec<usize> {
    let flash = flash_with(&stored_table());
    (0..flash.len()).filter(|at| flash[*at] != 0xFF).map(|at| FLASH + at).collect()
}

/// A board with the firmware and the reference arm's table in its flash, in a world, with power just come up.
///
/// # Panics
/// If the firmware does not build.
#[must_use]
pub fn machine<W: World>(world: W) -> Machine<W> {
    let mut machine = Machine::new(firmware(), world).expect("cargo built an ELF for the board");
    machine.load_flash(&flash_with(&stored_table()));
    machine
}
