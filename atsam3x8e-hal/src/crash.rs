//! Message of a crash that is retained over the reset, and the HardFault handler that records one.
//!
//! A text with a checksum is in RAM that start-up does not initialise (`.uninit` of cortex-m-rt). It is retained over any
//! reset without a loss of the RAM's supply.
//!
//! ```no_run
//! use atsam3x8e_hal::{crash, pwm};
//!
//! // At the start of main:
//! crash::on_fault(pwm::disable_all_outputs);
//! if let Some(text) = crash::take() {
//!     // report text.as_str()
//! }
//! # let info: &core::panic::PanicInfo = unimplemented!();
//!
//! // In the function marked #[panic_handler]:
//! crash::die(info, pwm::disable_all_outputs);
//! ```
//!
//! With the feature `rt`, a HardFault (to which every other fault escalates, as none has a handler) calls the
//! hook of [`on_fault`], records "HardFault pc=… cfsr=…" and resets. After a stack overflow it does so on an
//! empty stack.

use core::cell::{Cell, UnsafeCell};
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr;
use core::sync::atomic::{Ordering, fence};

use critical_section::Mutex;

use crate::reset;

#[cfg(all(feature = "rt", target_arch = "arm"))]
mod fault;

/// Capacity of a text, bytes; a longer one is cut.
pub const CAPACITY: usize = 96;

/// A recorded text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Text {
    length: u32,
    bytes: [u8; CAPACITY],
}

impl Text {
    const EMPTY: Self = Self { length: 0, bytes: [0; CAPACITY] };

    /// The text, up to the first byte that is not UTF-8.
    pub fn as_str(&self) -> &str {
        let bytes = self.bytes.get(..self.length as usize).unwrap_or(&self.bytes);
        match str::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => bytes.get(..error.valid_up_to()).and_then(|bytes| str::from_utf8(bytes).ok()).unwrap_or(""),
        }
    }

    /// FNV-1a over length and bytes, from an own start value so that zeroed memory does not pass.
    fn checksum(&self) -> u32 {
        const START: u32 = 0xC0A5_7EC5;
        let fold = |hash: u32, &byte: &u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        self.bytes.iter().fold(self.length.to_le_bytes().iter().fold(START, fold), fold)
    }
}

/// Appends up to the capacity and ignores the rest, so that formatting never fails.
impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let length = self.length as usize;
        if let Some(room) = self.bytes.get_mut(length..) {
            let count = room.len().min(text.len());
            room.iter_mut().zip(text.bytes()).for_each(|(to, byte)| *to = byte);
            self.length += count as u32;
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
#[repr(C)]
struct Record {
    text: Text,
    checksum: u32,
}

struct Uninit(UnsafeCell<MaybeUninit<Record>>);

// SAFETY: it is accessed by `store` and `load` alone, in critical sections.
unsafe impl Sync for Uninit {}

#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.atsam3x8e_hal_crash"))]
static RECORD: Uninit = Uninit(UnsafeCell::new(MaybeUninit::uninit()));

/// Function that brings the outputs to a safe state without waiting.
type SafeState = fn();

/// The function that the HardFault handler calls first.
static SAFE_STATE: Mutex<Cell<Option<SafeState>>> = Mutex::new(Cell::new(None));

/// Registers the function that the HardFault handler calls first, to bring the outputs to a safe state. It must not wait.
pub fn on_fault(safe_state: fn()) {
    critical_section::with(|token| SAFE_STATE.borrow(token).set(Some(safe_state)));
}

/// Records a text for [`take`], in place of an earlier one.
pub fn record(text: fmt::Arguments) {
    let mut recorded = Text::EMPTY;
    // `Text` never fails; after a `Display` that fails, the text until then is recorded.
    let _ = recorded.write_fmt(text);
    store(Record { checksum: recorded.checksum(), text: recorded });
}

/// Takes the text that was recorded before the reset, if any, and clears it.
pub fn take() -> Option<Text> {
    let Record { text, checksum } = load();
    if text.length as usize > CAPACITY || text.checksum() != checksum {
        return None;
    }
    store(Record { text: Text::EMPTY, checksum: !Text::EMPTY.checksum() });
    Some(text)
}

fn store(record: Record) {
    critical_section::with(|_| {
        // SAFETY: the address is that of a static, and the critical section makes this the only access. Volatile, since
        // nothing in this run of the program reads it.
        unsafe { ptr::write_volatile(RECORD.0.get(), MaybeUninit::new(record)) };
    });
    fence(Ordering::SeqCst);
}

fn load() -> Record {
    critical_section::with(|_| {
        let record: *const MaybeUninit<Record> = RECORD.0.get();
        // SAFETY: as in `store`; a volatile read of memory that an earlier boot wrote, or with the RAM's random
        // content. Any bits are a valid `Record`, which is integers without padding.
        unsafe { ptr::read_volatile(record).assume_init() }
    })
}

/// Ends the program after a panic: brings the outputs to a safe state, records location and message, then stops if a
/// debugger is attached, or else resets.
///
/// The text is the panic's location and message, cut at [`CAPACITY`] bytes.
pub fn die(info: &PanicInfo, safe_state: fn()) -> ! {
    critical_section::with(|_| {
        safe_state();
        match info.location() {
            Some(location) => {
                record(format_args!("{}:{}: {}", file_name(location.file()), location.line(), info.message()));
            }
            None => record(format_args!("{}", info.message())),
        }
        stop_or_reset()
    })
}

/// File name of a path, which is shorter.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// Halts for an attached debugger, which then shows the backtrace; resets otherwise.
fn stop_or_reset() -> ! {
    /// C_DEBUGEN of DHCSR (ARMv7-M C1.6.2).
    const C_DEBUGEN: u32 = 1;
    // SAFETY: DHCSR is always there, and reading it changes nothing the program uses.
    let debugger = unsafe { (*cortex_m::peripheral::DCB::PTR).dhcsr.read() } & C_DEBUGEN != 0;
    if debugger {
        cortex_m::asm::bkpt();
    }
    reset::reset()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    // One test: the record is one for the whole program.
    #[test]
    fn a_recorded_text_is_taken_once_and_cut_to_its_capacity() {
        record(format_args!("estimator.rs:{}: {}", 42, "index out of range"));
        assert_eq!(take().expect("a text was recorded").as_str(), "estimator.rs:42: index out of range");
        assert_eq!(take(), None);

        let long = "x".repeat(CAPACITY - 1) + "é and more";
        record(format_args!("{long}"));
        assert_eq!(take().expect("a text was recorded").as_str(), "x".repeat(CAPACITY - 1));
    }

    #[test]
    fn memory_that_holds_no_record_does_not_pass_for_one() {
        for byte in [0x00, 0xFF, 0xA5] {
            let text = Text { length: u32::from_ne_bytes([byte; 4]), bytes: [byte; CAPACITY] };
            let checksum = u32::from_ne_bytes([byte; 4]);
            assert!(text.length as usize > CAPACITY || text.checksum() != checksum, "memory full of {byte:#x}");
        }
    }

    #[test]
    fn a_location_is_named_by_its_file_alone() {
        assert_eq!(file_name("/home/lab/proprio/firmware/src/main.rs"), "main.rs");
        assert_eq!(file_name("main.rs"), "main.rs");
    }
}
