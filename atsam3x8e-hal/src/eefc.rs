//! Flash as storage, lock bits, unique identifier and boot selection (EEFC).
//!
//! [`Flash`] makes a region of the flash available as `embedded_storage::Storage`: any offset, any length. Each touched page of 256
//! bytes is read, changed, erased and written in one command (EWP), so that a loss of power damages at most that page: keep
//! two copies with a checksum.
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, eefc::Flash, pac};
//! use embedded_storage::{ReadStorage, Storage};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//! // The last 8 KiB of the second bank.
//! let mut flash = Flash::new(device.EFC0, device.EFC1, 0x000F_E000..0x0010_0000)?;
//! flash.write(0, b"calibration")?;
//! let mut first = [0; 11];
//! flash.read(0, &mut first)?;
//! let serial_number = flash.unique_id()?;
//! # let _ = (clocks, serial_number);
//! # Ok::<(), atsam3x8e_hal::eefc::Error>(())
//! ```
//!
//! # Interrupts
//!
//! A bank cannot be read while it is programmed (datasheet chapter 18), for some milliseconds a page (datasheet chapter 45,
//! embedded flash). The commands of the bank that has the program therefore run from RAM with interrupts off, and nothing
//! else runs meanwhile. The other bank is programmed with interrupts on: a task of low priority waits for it and disturbs
//! none of a higher one.

use core::ops::Range;

use embedded_storage::{ReadStorage, Storage};

use crate::{pac, reg};

mod command;
mod error;
mod layout;

pub use error::Error;
pub use layout::{BANKS, LOCK_REGION_SIZE, PAGE_SIZE};

use command::{Command, execute, read_unique_id};

/// FWS 6 while programming, at any clock (datasheet errata, flash programming).
const FMR_PROGRAMMING: u32 = 6 << 8;
/// The same with SCOD: no prefetch while the array shows the identifier instead of the program (datasheet chapter 18, EEFC_FMR).
const FMR_READING_ID: u32 = 6 << 8 | 1 << 16;

/// A region of the flash, and the two controllers.
#[derive(Debug)]
pub struct Flash {
    efc0: pac::EFC0,
    efc1: pac::EFC1,
    region: Range<u32>,
}

impl Flash {
    /// Takes the flash controllers, for a region of addresses in whole pages.
    ///
    /// # Errors
    ///
    /// [`Error::Region`]; with the feature `rt`, [`Error::Program`].
    pub fn new(efc0: pac::EFC0, efc1: pac::EFC1, region: Range<u32>) -> Result<Self, Error> {
        let [first_bank, second_bank] = BANKS;
        let aligned = region.start.is_multiple_of(PAGE_SIZE) && region.end.is_multiple_of(PAGE_SIZE);
        if region.is_empty() || !aligned || region.start < first_bank.start || region.end > second_bank.end {
            return Err(Error::Region);
        }
        if region.start < program_end() {
            return Err(Error::Program);
        }
        Ok(Self { efc0, efc1, region })
    }

    /// Returns whether the lock region of an address is locked.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfBounds`] for an address outside the flash; those of the controller.
    pub fn is_locked(&mut self, address: u32) -> Result<bool, Error> {
        let (bank, page) = bank_and_page(address)?;
        let bits = self.command(bank, Command::GetLockBits, 0)?;
        Ok(bits >> (page / (LOCK_REGION_SIZE / PAGE_SIZE)) & 1 == 1)
    }

    /// Locks the lock region of an address against programming, until it is unlocked; resets do not unlock it.
    ///
    /// # Errors
    ///
    /// As [`Self::is_locked`].
    pub fn lock(&mut self, address: u32) -> Result<(), Error> {
        let (bank, page) = bank_and_page(address)?;
        self.command(bank, Command::SetLockBit, page).map(|_| ())
    }

    /// Unlocks the lock region of an address.
    ///
    /// # Errors
    ///
    /// As [`Self::is_locked`].
    pub fn unlock(&mut self, address: u32) -> Result<(), Error> {
        let (bank, page) = bank_and_page(address)?;
        self.command(bank, Command::ClearLockBit, page).map(|_| ())
    }

    /// Returns whether the chip boots from flash (GPNVM1) and not into the boot loader in ROM (datasheet chapter 7, boot strategies).
    ///
    /// # Errors
    ///
    /// Those of the controller.
    pub fn boots_from_flash(&mut self) -> Result<bool, Error> {
        self.command(Bank::First, Command::GetGpnvmBits, 0).map(|bits| bits >> 1 & 1 == 1)
    }

    /// The chip's 128-bit serial number (datasheet chapter 18, unique identifier).
    ///
    /// # Errors
    ///
    /// Those of the controller.
    pub fn unique_id(&mut self) -> Result<[u8; 16], Error> {
        let words = self.with_mode(Bank::First, FMR_READING_ID, read_unique_id)?;
        let mut id = [0; 16];
        id.as_chunks_mut()
            .0
            .iter_mut()
            .zip(words)
            .for_each(|(bytes, word): (&mut [u8; 4], u32)| *bytes = word.to_le_bytes());
        Ok(id)
    }

    /// Erases and writes one page.
    fn write_page(&mut self, address: u32, content: &[u8; PAGE_SIZE as usize]) -> Result<(), Error> {
        let (bank, page) = bank_and_page(address)?;
        self.with_mode(bank, FMR_PROGRAMMING, |efc| {
            // Writing to the array, by words in ascending order and with the wait states of programming, fills the page's
            // latch buffer (datasheet chapter 18, write commands).
            for (index, word) in content.as_chunks().0.iter().enumerate() {
                let latch = (address as usize + 4 * index) as *mut u32;
                // SAFETY: the page is in the region, which `new` has checked to be flash and, with `rt`, none of the
                // program's; the write goes to the latch buffer and changes no memory before the command.
                unsafe { latch.write_volatile(u32::from_le_bytes(*word)) };
            }
            execute(efc, Command::EraseAndWritePage, page).map(|_| ())
        })
    }

    fn command(&mut self, bank: Bank, command: Command, argument: u32) -> Result<u32, Error> {
        self.with_mode(bank, FMR_PROGRAMMING, |efc| execute(efc, command, argument))
    }

    /// Runs with the bank in another mode, and with interrupts off if the program is in this bank.
    fn with_mode<T>(&mut self, bank: Bank, mode: u32, run: impl FnOnce(&pac::efc0::RegisterBlock) -> T) -> T {
        let efc = self.controller(bank);
        let run = || {
            let before = efc.fmr.read().bits();
            reg::set(&efc.fmr, mode);
            let result = run(efc);
            reg::set(&efc.fmr, before);
            result
        };
        if bank.has_program() { critical_section::with(|_| run()) } else { run() }
    }

    fn controller(&self, bank: Bank) -> &pac::efc0::RegisterBlock {
        match bank {
            Bank::First => &self.efc0,
            Bank::Second => {
                let efc1: &pac::efc1::RegisterBlock = &self.efc1;
                // SAFETY: both controllers have the same registers (datasheet chapter 18); the reference borrows the EFC1.
                unsafe { &*core::ptr::from_ref(efc1).cast() }
            }
        }
    }

    /// Address of an offset, if `length` bytes from there are within the region.
    fn address(&self, offset: u32, length: usize) -> Result<u32, Error> {
        let end = u64::from(offset) + length as u64;
        if end > u64::from(self.region.end - self.region.start) {
            return Err(Error::OutOfBounds);
        }
        Ok(self.region.start + offset)
    }
}

/// The region as it is mapped to memory.
impl AsRef<[u8]> for Flash {
    fn as_ref(&self) -> &[u8] {
        let length = (self.region.end - self.region.start) as usize;
        // SAFETY: the region is flash, which is always readable; it changes through `&mut self` alone.
        unsafe { core::slice::from_raw_parts(self.region.start as *const u8, length) }
    }
}

impl ReadStorage for Flash {
    type Error = Error;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        let address = self.address(offset, bytes.len())?;
        for (index, byte) in bytes.iter_mut().enumerate() {
            // SAFETY: the address is in the region, which is flash, and always readable.
            *byte = unsafe { ((address as usize + index) as *const u8).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        (self.region.end - self.region.start) as usize
    }
}

impl Storage for Flash {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        self.address(offset, bytes.len())?;
        let mut rest = bytes;
        let mut offset = offset;
        while !rest.is_empty() {
            let (page, within, count) = page_part(offset, rest.len());
            let (now, later) = rest.split_at(count);
            let mut content = [0; PAGE_SIZE as usize];
            self.read(page, &mut content)?;
            content.iter_mut().skip(within).zip(now).for_each(|(to, byte)| *to = *byte);
            self.write_page(self.region.start + page, &content)?;
            rest = later;
            offset += count as u32;
        }
        Ok(())
    }
}

/// The page of an offset, the place in it, and how many of `length` bytes are in this page.
fn page_part(offset: u32, length: usize) -> (u32, usize, usize) {
    let within = offset % PAGE_SIZE;
    (offset - within, within as usize, length.min((PAGE_SIZE - within) as usize))
}

/// A flash bank with its controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bank {
    First,
    Second,
}

impl Bank {
    /// Returns whether a part of the program can be in this bank.
    fn has_program(self) -> bool {
        let [_, second] = BANKS;
        self == Self::First || program_end() == 0 || program_end() > second.start
    }
}

/// Bank of an address, and its page in it.
fn bank_and_page(address: u32) -> Result<(Bank, u32), Error> {
    let [first, second] = BANKS;
    if first.contains(&address) {
        Ok((Bank::First, (address - first.start) / PAGE_SIZE))
    } else if second.contains(&address) {
        Ok((Bank::Second, (address - second.start) / PAGE_SIZE))
    } else {
        Err(Error::OutOfBounds)
    }
}

/// Address after the program's image: its code, constants, and the start values of `.data`.
#[cfg(all(feature = "rt", target_arch = "arm"))]
fn program_end() -> u32 {
    // Symbols of cortex-m-rt's linker script.
    unsafe extern "C" {
        static __sdata: u32;
        static __edata: u32;
        static __sidata: u32;
    }
    let data = (&raw const __edata as u32) - (&raw const __sdata as u32);
    &raw const __sidata as u32 + data
}

/// Unknown without cortex-m-rt's linker script.
#[cfg(not(all(feature = "rt", target_arch = "arm")))]
fn program_end() -> u32 {
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_its_bank_and_its_page_there() {
        assert_eq!(bank_and_page(0x0008_0000), Ok((Bank::First, 0)));
        assert_eq!(bank_and_page(0x000B_FFFF), Ok((Bank::First, 1023)));
        assert_eq!(bank_and_page(0x000C_0100), Ok((Bank::Second, 1)));
        assert_eq!(bank_and_page(0x0010_0000), Err(Error::OutOfBounds));
        assert_eq!(bank_and_page(0x0007_FFFF), Err(Error::OutOfBounds));
    }

    #[test]
    fn a_write_is_split_at_page_boundaries() {
        assert_eq!(page_part(0, 10), (0, 0, 10));
        assert_eq!(page_part(250, 10), (0, 250, 6));
        assert_eq!(page_part(256, 1000), (256, 0, 256));
        assert_eq!(page_part(511, 1), (256, 255, 1));
    }
}
