//! CPU load, from the time asleep.

use atsam3x8e_hal::tc::Mono;
use core::sync::atomic::{AtomicU32, Ordering};

/// Time asleep since boot, in ticks of [`Mono`]; wraps.
static ASLEEP: AtomicU32 = AtomicU32::new(0);

/// Sleeps until an interrupt is pending and counts the time. The interrupt is served after it.
pub fn sleep() {
    cortex_m::interrupt::free(|_| {
        let before = Mono::now_ticks();
        cortex_m::asm::wfi();
        let asleep = Mono::now_ticks().wrapping_sub(before) as u32;
        ASLEEP.store(ASLEEP.load(Ordering::Relaxed).wrapping_add(asleep), Ordering::Relaxed);
    });
}

/// CPU load from one call of [`permille`](Self::permille) to the next.
pub struct CpuLoad {
    asleep: u32,
    at: u64,
}

impl CpuLoad {
    /// Starts to measure now.
    pub fn new() -> Self {
        Self { asleep: ASLEEP.load(Ordering::Relaxed), at: Mono::now_ticks() }
    }

    /// Share of the time since the last call that the processor was not asleep, 0.1 %.
    pub fn permille(&mut self) -> u16 {
        let now = Self::new();
        let slept = now.asleep.wrapping_sub(self.asleep);
        let passed = now.at.wrapping_sub(self.at) as u32;
        *self = now;
        let share = u64::from(passed.saturating_sub(slept)) * 1000 / u64::from(passed.max(1));
        share as u16
    }
}
