//! The host's clock.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// A time of the host, ns since 1970, UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct HostNs(pub u64);

/// The host's clock: set by the system's clock once and monotonic from then on, also when the system's clock is set.
#[derive(Debug, Clone, Copy)]
pub struct HostClock {
    start: Instant,
    start_ns: u64,
}

impl HostClock {
    /// A clock that is set by the system's clock.
    #[must_use]
    pub fn new() -> Self {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { start: Instant::now(), start_ns: since_1970.as_nanos() as u64 }
    }

    /// The time now.
    #[must_use]
    pub fn now(&self) -> HostNs {
        HostNs(self.start_ns + self.start.elapsed().as_nanos() as u64)
    }
}

impl Default for HostClock {
    fn default() -> Self {
        Self::new()
    }
}
