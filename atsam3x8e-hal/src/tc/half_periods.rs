//! Ticks of channel 1, extended to 64 bits by a count of its half periods.

use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

use crate::clock::MCK_HZ;
use crate::pac;

/// Ticks of both channels a second: TIMER_CLOCK1 is MCK/2 (datasheet 36.6.3).
pub const TICK_HZ: u32 = MCK_HZ / 2;

/// Status and interrupt bits (datasheet chapter 36, TC_SR); reading the status clears them all.
pub(super) const COVFS: u32 = 1 << 0;
pub(super) const CPAS: u32 = 1 << 2;
pub(super) const CPCS: u32 = 1 << 4;

pub(super) fn block() -> &'static pac::tc0::RegisterBlock {
    // SAFETY: the block is always there; `split` consumed it, and the owners of the two channels each use their own
    // channel's registers.
    unsafe { &*pac::TC0::ptr() }
}

static HALF_PERIODS: AtomicU32 = AtomicU32::new(0);

/// Ticks of 1/42 µs since the start of channel 1.
pub(super) fn now_ticks() -> u64 {
    // Without the critical section, a preemption of half a period between the two reads would be an error.
    critical_section::with(|_| {
        let half_periods = HALF_PERIODS.load(Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        extend(half_periods, block().cv1.read().bits())
    })
}

/// Counts the half periods that the status shows. The only read of the channel's status, since reading clears it.
pub(super) fn count_half_periods() {
    let status = block().sr1.read().bits();
    let passed = u32::from(status & CPAS != 0) + u32::from(status & COVFS != 0);
    // The only writer is this interrupt, so that load and store need no atomic add.
    HALF_PERIODS.store(HALF_PERIODS.load(Ordering::Relaxed).wrapping_add(passed), Ordering::Relaxed);
}

/// Joins the count of half periods, read first, with the counter, read second.
///
/// An odd count belongs to a counter in its upper half. If count and counter disagree, the counter has passed into the next
/// half since the count was taken.
fn extend(half_periods: u32, counter: u32) -> u64 {
    let upper_half_expected = (half_periods & 1) << 31;
    (u64::from(half_periods) << 31) + u64::from(upper_half_expected ^ counter)
}

#[cfg(test)]
mod tests {
    use super::extend;

    #[test]
    fn time_is_the_same_whether_or_not_the_half_period_was_already_counted() {
        for time in [0x8000_0000_u64, 0x8000_0005, 0x1_0000_0000, 0x1_0000_0005, 0x7_8000_0000, 0x8_0000_0003] {
            let counted = (time >> 31) as u32;
            assert_eq!(extend(counted, time as u32), time, "counted");
            assert_eq!(extend(counted - 1, time as u32), time, "not yet counted");
        }
    }

    #[test]
    fn time_does_not_step_within_a_half_period() {
        assert_eq!(extend(0, 0), 0);
        assert_eq!(extend(0, 0x7FFF_FFFF), 0x7FFF_FFFF);
        assert_eq!(extend(3, 0xFFFF_FFFF), 0x1_FFFF_FFFF);
    }
}
