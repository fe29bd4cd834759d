//! [`Mono`] as a monotonic of RTIC.

use rtic_time::fugit;
use rtic_time::monotonic::TimerQueueBasedMonotonic;

use super::Mono;
use super::half_periods::TICK_HZ;
use super::rtic::Backend;

impl TimerQueueBasedMonotonic for Mono {
    type Backend = Backend;
    type Instant = fugit::MonotonicTimerInstant<u64, TICK_HZ_U64>;
    type Duration = fugit::TimerDuration<u64, TICK_HZ_U64>;
}

const TICK_HZ_U64: u64 = TICK_HZ as u64;

rtic_time::impl_embedded_hal_delay_fugit!(Mono);
rtic_time::impl_embedded_hal_async_delay_fugit!(Mono);
