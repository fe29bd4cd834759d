//! The chip's flash as its controllers see it (datasheet 7, "Product mapping").

/// Address of the first bank; the second follows it.
pub const FLASH: u32 = 0x0008_0000;
/// Bytes in a bank.
pub const BANK: u32 = 0x4_0000;

/// The bytes of one bank, which the CPU reads while its controller changes them.
pub trait FlashBank {
    /// Copies out the bytes at `offset`; does nothing and returns false if they exceed the bank.
    fn read(&self, offset: usize, to: &mut [u8]) -> bool;

    /// Copies bytes in at `offset`; does nothing and returns false if they exceed the bank.
    fn write(&self, offset: usize, from: &[u8]) -> bool;

    /// Sets all bytes of the bank.
    fn fill(&self, byte: u8);
}
