//! A flash in memory that loses power after a given number of bytes.

use board_table::{PAGE_BYTES, STORE_BYTES};
use embedded_storage::{ReadStorage, Storage};

/// The power is gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PowerLoss;

/// A flash in memory. A page is erased, then written byte by byte, until the power is lost.
#[derive(Debug, Clone)]
pub struct MockFlash {
    pub bytes: Vec<u8>,
    /// Bytes that can be written before the power is lost; the erasure of a page counts as one.
    pub budget: usize,
    /// Bit that cannot be programmed to 0.
    pub stuck: Option<(usize, u8)>,
}

impl MockFlash {
    pub fn new() -> Self {
        Self { bytes: vec![0xFF; STORE_BYTES], budget: usize::MAX, stuck: None }
    }

    fn spend(&mut self) -> Result<(), PowerLoss> {
        self.budget = self.budget.checked_sub(1).ok_or(PowerLoss)?;
        Ok(())
    }
}

impl ReadStorage for &mut MockFlash {
    type Error = PowerLoss;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLoss> {
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl Storage for &mut MockFlash {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerLoss> {
        let offset = offset as usize;
        assert!(offset.is_multiple_of(PAGE_BYTES) && bytes.len() == PAGE_BYTES, "whole pages alone");
        self.spend()?;
        self.bytes[offset..][..PAGE_BYTES].fill(0xFF);
        for (index, byte) in bytes.iter().enumerate() {
            self.spend()?;
            let forced = self.stuck.filter(|(place, _)| *place == offset + index).map_or(0, |(_, bit)| bit);
            self.bytes[offset + index] = byte | forced;
        }
        Ok(())
    }
}

impl AsRef<[u8]> for MockFlash {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}
