//! The HardFault handler.

use core::arch::naked_asm;

use super::{SAFE_STATE, record, stop_or_reset};

/// Stack of the handler, bytes, with a margin.
const ROOM: u32 = 1024;

/// Entry from the processor. The stack may be the fault's cause, so that nothing is pushed before it is known to have
/// [`ROOM`]; if it has not, the stack pointer is set to its top, since nothing returns to the old stack. Otherwise it is
/// unchanged: the frame is on it, perhaps at its very top. The frame's address is the argument of the next function.
#[unsafe(naked)]
#[unsafe(no_mangle)]
#[unsafe(link_section = ".HardFault.atsam3x8e_hal")]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        // Bit 2 of EXC_RETURN: the frame is on the process stack (ARMv7-M B1.5.8).
        "tst lr, #4",
        "ite eq",
        "mrseq r0, msp",
        "mrsne r0, psp",
        "movw r1, #:lower16:_stack_end",
        "movt r1, #:upper16:_stack_end",
        "add r1, r1, {room}",
        "mrs r2, msp",
        "cmp r2, r1",
        "ittt lo",
        "movwlo r2, #:lower16:_stack_start",
        "movtlo r2, #:upper16:_stack_start",
        "msrlo msp, r2",
        "b {handler}",
        room = const ROOM,
        handler = sym hard_fault,
    )
}

/// The eight words that the processor stacks (ARMv7-M B1.5.6).
const FRAME_BYTES: u32 = 32;
/// Offset of the return address in them.
const FRAME_PC: u32 = 24;

extern "C" fn hard_fault(frame: u32) -> ! {
    critical_section::with(|token| {
        if let Some(safe_state) = SAFE_STATE.borrow(token).get() {
            safe_state();
        }
        // SAFETY: the system control block is always there, and reading the fault status changes nothing.
        let cfsr = unsafe { (*cortex_m::peripheral::SCB::PTR).cfsr.read() };
        match stacked_pc(frame, cfsr) {
            Some(pc) => record(format_args!("HardFault pc={pc:#010x} cfsr={cfsr:#010x}")),
            None => record(format_args!("HardFault pc=? sp={frame:#010x} cfsr={cfsr:#010x}: stack overflow?")),
        }
        stop_or_reset()
    })
}

/// The faulting address, if the processor could stack it and the stack lies in RAM.
fn stacked_pc(frame: u32, cfsr: u32) -> Option<u32> {
    /// MSTKERR and STKERR: stacking failed (ARMv7-M B3.2.15).
    const STACKING_FAILED: u32 = 1 << 4 | 1 << 12;
    if cfsr & STACKING_FAILED != 0 || !is_in_ram(frame) {
        return None;
    }
    let pc = (frame + FRAME_PC) as *const u32;
    // SAFETY: the frame lies in RAM, is aligned, and was just written by the processor.
    Some(unsafe { pc.read_volatile() })
}

/// Returns whether a whole frame is in the chip's RAM: SRAM0 (64 KiB), or SRAM1 (32 KiB) with the contiguous alias below it
/// (datasheet chapter 7).
fn is_in_ram(frame: u32) -> bool {
    let fits = |start: u32, end: u32| (start..=end - FRAME_BYTES).contains(&frame);
    frame.is_multiple_of(4) && (fits(0x2000_0000, 0x2001_0000) || fits(0x2007_0000, 0x2008_8000))
}
