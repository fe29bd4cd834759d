//! A flash in memory.

use board_table::STORE_BYTES;
use embedded_storage::{ReadStorage, Storage};

/// Room for the two slots of a board's table, erased.
#[derive(Debug, Clone)]
pub struct RamFlash(Vec<u8>);

/// A place outside of the flash.
#[derive(Debug)]
pub struct OutOfFlash;

impl RamFlash {
    /// An erased flash.
    pub fn new() -> Self {
        Self(vec![0xFF; STORE_BYTES])
    }

    fn place(&mut self, offset: u32, length: usize) -> Result<&mut [u8], OutOfFlash> {
        self.0.get_mut(offset as usize..).and_then(|rest| rest.get_mut(..length)).ok_or(OutOfFlash)
    }
}

impl ReadStorage for RamFlash {
    type Error = OutOfFlash;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), OutOfFlash> {
        bytes.copy_from_slice(self.place(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl Storage for RamFlash {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), OutOfFlash> {
        self.place(offset, bytes.len())?.copy_from_slice(bytes);
        Ok(())
    }
}

impl AsRef<[u8]> for RamFlash {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
