//! Commands of a flash controller, executed from RAM.

use super::error::Error;
use super::layout::BANKS;
use crate::pac;

/// FKEY of the command register (datasheet chapter 18, EEFC_FCR).
const KEY: u32 = 0x5A << 24;
const FRDY: u32 = 1 << 0;
const FCMDE: u32 = 1 << 1;
const FLOCKE: u32 = 1 << 2;

/// Polls before a command counts as failed: at least 70 ms at 84 MHz, where the longest one takes some milliseconds
/// (datasheet chapter 45, embedded flash).
const POLLS: u32 = 1_000_000;

/// Start and stop of reading the unique identifier (datasheet chapter 18, unique identifier).
const START_UNIQUE_ID: u32 = 0x0E;
const STOP_UNIQUE_ID: u32 = 0x0F;

/// Commands (datasheet chapter 18, set of commands).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Command {
    EraseAndWritePage = 0x03,
    SetLockBit = 0x08,
    ClearLockBit = 0x09,
    GetLockBits = 0x0A,
    GetGpnvmBits = 0x0D,
}

/// Executes a command; gives the result register. Interrupts are off if the program is in the same bank.
pub(super) fn execute(efc: &pac::efc0::RegisterBlock, command: Command, argument: u32) -> Result<u32, Error> {
    let fcr = KEY | argument << 8 | command as u32;
    // SAFETY: the addresses are those of a controller's command and status registers.
    let status = unsafe { write_and_wait(efc.fcr.as_ptr(), fcr, efc.fsr.as_ptr(), POLLS) };
    check(status)?;
    Ok(efc.frr.read().bits())
}

/// Reads the first four words of the bank while it shows the identifier instead of the program.
pub(super) fn read_unique_id(efc: &pac::efc0::RegisterBlock) -> Result<[u32; 4], Error> {
    let mut words = [0; 4];
    let [first_bank, _] = BANKS;
    // SAFETY: the addresses are those of the first bank, of its controller, and of four words to write to.
    let status = unsafe { read_words(first_bank.start as *const u32, words.as_mut_ptr(), efc.fcr.as_ptr(), POLLS) };
    check(status)?;
    Ok(words)
}

/// Errors of a status register's content.
fn check(status: u32) -> Result<(), Error> {
    if status & FRDY == 0 {
        Err(Error::Timeout)
    } else if status & FLOCKE != 0 {
        Err(Error::Locked)
    } else if status & FCMDE != 0 {
        Err(Error::Command)
    } else {
        Ok(())
    }
}

/// Writes a command and polls the status until it is ready, at most `polls` times. Gives all status bits seen: reading
/// clears the errors.
///
/// In assembly and in `.data`, since while the bank is busy not a single instruction may come from flash.
///
/// # Safety
///
/// `fcr` and `fsr` are a flash controller's registers, and interrupts are off or no interrupt's code is in its bank.
#[cfg(target_arch = "arm")]
#[unsafe(naked)]
#[unsafe(link_section = ".data.atsam3x8e_hal_write_and_wait")]
unsafe extern "C" fn write_and_wait(fcr: *mut u32, command: u32, fsr: *mut u32, polls: u32) -> u32 {
    core::arch::naked_asm!(
        "str r1, [r0]",
        "movs r0, #0",
        "1:",
        "ldr r1, [r2]",
        "orrs r0, r1",
        "lsls r1, r1, #31",
        "bne 2f",
        "subs r3, #1",
        "bne 1b",
        "2:",
        "bx lr",
    )
}

/// Starts the identifier, waits until FRDY falls, copies four words, stops it, and waits until FRDY rises. Gives the status
/// bits seen at the end, or 0 if FRDY did not fall.
///
/// # Safety
///
/// `from` and `to` are four words each, `fcr` is the command register of a flash controller with the status register after
/// it, and interrupts are off.
#[cfg(target_arch = "arm")]
#[unsafe(naked)]
#[unsafe(link_section = ".data.atsam3x8e_hal_read_words")]
unsafe extern "C" fn read_words(from: *const u32, to: *mut u32, fcr: *mut u32, polls: u32) -> u32 {
    core::arch::naked_asm!(
        "push {{r4, r5, r6, r7}}",
        "movs r7, #0",
        "movs r5, #0x5A",
        "lsls r5, r5, #24",
        "adds r4, r5, #{start}",
        "str r4, [r2]",
        "mov r6, r3",
        // FRDY falls when the identifier can be read.
        "1:",
        "ldr r4, [r2, #4]",
        "lsls r4, r4, #31",
        "beq 2f",
        "subs r6, #1",
        "bne 1b",
        "b 3f",
        "2:",
        "ldr r4, [r0]",
        "str r4, [r1]",
        "ldr r4, [r0, #4]",
        "str r4, [r1, #4]",
        "ldr r4, [r0, #8]",
        "str r4, [r1, #8]",
        "ldr r4, [r0, #12]",
        "str r4, [r1, #12]",
        "mvns r7, r7",
        // Stopped in any case: the program comes back into view.
        "3:",
        "adds r4, r5, #{stop}",
        "str r4, [r2]",
        "movs r0, #0",
        "4:",
        "ldr r4, [r2, #4]",
        "orrs r0, r4",
        "lsls r4, r4, #31",
        "bne 5f",
        "subs r3, #1",
        "bne 4b",
        "5:",
        "ands r0, r7",
        "pop {{r4, r5, r6, r7}}",
        "bx lr",
        start = const START_UNIQUE_ID,
        stop = const STOP_UNIQUE_ID,
    )
}

/// For documentation and tests on a host, which have no flash controller.
#[cfg(not(target_arch = "arm"))]
unsafe fn write_and_wait(_fcr: *mut u32, _command: u32, _fsr: *mut u32, _polls: u32) -> u32 {
    0
}

/// For documentation and tests on a host, which have no flash controller.
#[cfg(not(target_arch = "arm"))]
unsafe fn read_words(_from: *const u32, _to: *mut u32, _fcr: *mut u32, _polls: u32) -> u32 {
    let _ = (START_UNIQUE_ID, STOP_UNIQUE_ID);
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_names_its_error() {
        assert_eq!(check(FRDY), Ok(()));
        assert_eq!(check(FRDY | FLOCKE), Err(Error::Locked));
        assert_eq!(check(FRDY | FCMDE), Err(Error::Command));
        assert_eq!(check(0), Err(Error::Timeout));
    }
}
