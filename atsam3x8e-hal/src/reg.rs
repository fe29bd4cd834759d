//! Writing registers: the PAC's write-only registers have no reset value, so that `write` does not exist for them, and its
//! `write_with_zero` is unsafe.

use atsam3x::{Reg, RegisterSpec, Writable};

/// Writes a whole register.
///
/// For registers that move no memory; pointers and counters of the PDC are written where their buffer is owned.
#[inline]
pub(crate) fn set<R: Writable + RegisterSpec<Ux = u32>>(register: &Reg<R>, value: u32) {
    // SAFETY: the callers in this crate pass values by the datasheet's definitions, cited where they are made, and no such
    // value lets the hardware access memory.
    unsafe { register.write_with_zero(|w| w.bits(value)) }
}

/// Polls until `ready`, at most `polls` times. Returns whether it became ready.
pub(crate) fn wait(polls: u32, mut ready: impl FnMut() -> bool) -> bool {
    (0..polls).any(|_| ready())
}
