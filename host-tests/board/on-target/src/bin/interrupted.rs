//! The estimator's arithmetic while an interrupt strikes every 97 to 211 cycles, inside IT blocks too.
#![no_std]
#![no_main]

use core::arch::naked_asm;
use core::fmt::Write;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use atsam3x8e_hal::pac::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use on_target_tests::arithmetic::hashes;
use on_target_tests::line::Line;

const INPUTS: u32 = 50_000;
/// Shortest time from one interrupt to the next, cycles; the time varies, so that every instruction is interrupted some time.
const SHORTEST: u32 = 97;
const LONGEST: u32 = 211;

static INTERRUPTS: AtomicU32 = AtomicU32::new(0);
static IN_IT_BLOCKS: AtomicU32 = AtomicU32::new(0);

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut line = Line::open(Peripherals::take().expect("it is the first"));
    let mut timer = cortex_m::Peripherals::take().expect("it is the first").SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(SHORTEST);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
    for (name, hash) in hashes(INPUTS) {
        let _ = writeln!(line, "{name} {hash:08x}");
    }
    timer.disable_interrupt();
    let _ = writeln!(line, "interrupts {}", INTERRUPTS.load(Relaxed));
    let _ = writeln!(line, "in IT blocks {}", IN_IT_BLOCKS.load(Relaxed));
    line.close()
}

/// Entered by the processor: passes on the address of the stacked registers.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn SysTick() {
    naked_asm!("mov r0, sp", "b {handler}", handler = sym on_interrupt)
}

/// Counts, and changes registers and flags.
extern "C" fn on_interrupt(stacked: &[u32; 8]) {
    /// The lower half of the stacked ITSTATE; it is not zero inside an IT block (ARMv7-M A7.3.3, B1.4.2).
    const IT_BLOCK: u32 = 0x0600_0C00;
    let count = INTERRUPTS.load(Relaxed);
    INTERRUPTS.store(count + 1, Relaxed);
    if stacked[7] & IT_BLOCK != 0 {
        IN_IT_BLOCKS.store(IN_IT_BLOCKS.load(Relaxed) + 1, Relaxed);
    }
    let period = SHORTEST + count % (LONGEST - SHORTEST + 1);
    // SAFETY: SysTick is always there, and `main` does not touch its reload value while it runs.
    unsafe { (*SYST::PTR).rvr.write(period) };
}
