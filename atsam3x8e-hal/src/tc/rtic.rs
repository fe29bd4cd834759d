//! [`Mono`] as a monotonic of RTIC: the timer queue waits on channel 1's RC compare.

use rtic_time::fugit;
use rtic_time::monotonic::TimerQueueBasedMonotonic;
use rtic_time::timer_queue::{TimerQueue, TimerQueueBackend};

use super::{Mono, TICK_HZ, block, count_half_periods};
use crate::{pac, reg};

/// The timer queue's side of channel 1.
#[derive(Debug)]
pub struct Backend(());

static QUEUE: TimerQueue<Backend> = TimerQueue::new();

pub(super) fn initialize() {
    QUEUE.initialize(Backend(()));
}

pub(super) fn on_interrupt() {
    // SAFETY: always safe; the queue asks that only the timer's interrupt calls it, as `Mono::on_interrupt` documents.
    unsafe { QUEUE.on_monotonic_interrupt() };
}

impl TimerQueueBackend for Backend {
    type Ticks = u64;

    fn now() -> u64 {
        Mono::now_ticks()
    }

    /// An instant more than 2³² ticks ahead compares too early; the queue then looks at the time and sets it again.
    fn set_compare(instant: u64) {
        reg::set(&block().rc1, instant as u32);
    }

    /// Nothing: [`count_half_periods`] clears the compare flag with the others.
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

impl TimerQueueBasedMonotonic for Mono {
    type Backend = Backend;
    type Instant = fugit::MonotonicTimerInstant<u64, TICK_HZ_U64>;
    type Duration = fugit::TimerDuration<u64, TICK_HZ_U64>;
}

const TICK_HZ_U64: u64 = TICK_HZ as u64;

rtic_time::impl_embedded_hal_delay_fugit!(Mono);
rtic_time::impl_embedded_hal_async_delay_fugit!(Mono);
