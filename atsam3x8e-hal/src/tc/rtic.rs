//! Timer queue of RTIC, which waits on channel 1's RC compare.

use rtic_time::timer_queue::{TimerQueue, TimerQueueBackend};

use super::half_periods::{block, count_half_periods, now_ticks};
use crate::{pac, reg};

/// The timer queue's side of channel 1.
#[derive(Debug)]
pub struct Backend(());

static QUEUE: TimerQueue<Backend> = TimerQueue::new();

pub(super) fn initialize() {
    QUEUE.initialize(Backend(()));
}

pub(super) fn on_interrupt() {
    // SAFETY: always safe; the queue requires that only the timer's interrupt calls it, as `Mono::on_interrupt` documents.
    unsafe { QUEUE.on_monotonic_interrupt() };
}

impl TimerQueueBackend for Backend {
    type Ticks = u64;

    fn now() -> u64 {
        now_ticks()
    }

    /// An instant more than 2³² ticks ahead compares too early; the queue then reads the time and sets it again.
    fn set_compare(instant: u64) {
        reg::set(&block().rc1, instant as u32);
    }

    /// Does nothing: [`count_half_periods`] clears the compare flag with the others.
    fn clear_compare_flag() {}

    fn pend_interrupt() {
        cortex_m::peripheral::NVIC::pend(pac::Interrupt::TC1);
    }

    fn on_interrupt() {
        count_half_periods();
    }

    fn timer_queue() -> &'static TimerQueue<Self> {
        &QUEUE
    }
}
