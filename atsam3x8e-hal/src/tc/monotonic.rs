//! [`Mono`] as a monotonic of RTIC.

use rtic_time::Timebase;
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

impl Mono {
    /// The instant so many microseconds after the start; one that is past the end of time is the last.
    pub const fn instant(time_us: u64) -> <Self as Timebase>::Instant {
        <Self as Timebase>::Instant::from_ticks(time_us.saturating_mul(TICK_HZ_U64 / 1_000_000))
    }
}

const TICK_HZ_U64: u64 = TICK_HZ as u64;

rtic_time::impl_embedded_hal_delay_fugit!(Mono);
rtic_time::impl_embedded_hal_async_delay_fugit!(Mono);
