//! The board's time on the host's clock.

use crate::link::HostNs;

/// Time over which the shortest delay is looked for, ns; two crystals part by less than 1 ms meanwhile.
const BLOCK_NS: u64 = 10_000_000_000;

/// Relates the time stamps of a board to the times at which they came.
///
/// A message is delayed on its way, sometimes more and never less than some milliseconds: of the last ten to twenty seconds
/// the message with the shortest delay tells how the clocks stand to each other. No time is later than its arrival.
#[derive(Debug, Default)]
pub struct BoardClock {
    block_start: u64,
    /// Least difference of host and board, ns, in this block and the one before.
    least: Option<i64>,
    least_before: Option<i64>,
    last_us: u64,
}

impl BoardClock {
    /// The time on the host's clock of what the board has stamped with `board_us` and what came at `at`.
    pub fn host_ns(&mut self, at: HostNs, board_us: u64) -> HostNs {
        if board_us < self.last_us {
            // It has restarted.
            *self = Self::default();
        }
        self.last_us = board_us;
        if at.0.saturating_sub(self.block_start) > BLOCK_NS {
            self.block_start = at.0;
            self.least_before = self.least.take();
        }
        let board_ns = board_us.saturating_mul(1000) as i64;
        let difference = (at.0 as i64).saturating_sub(board_ns);
        let least = self.least.map_or(difference, |least| least.min(difference));
        self.least = Some(least);
        let least = self.least_before.map_or(least, |before| before.min(least));
        HostNs(board_ns.saturating_add(least).max(0) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::{BoardClock, HostNs};

    /// 10⁹ s after 1970.
    const START_NS: u64 = 1_000_000_000_000_000_000;

    #[test]
    fn jitter_of_the_line_is_taken_out() {
        let mut clock = BoardClock::default();
        let mut last = 0;
        for tick in 0..3000_u64 {
            let board_us = tick * 10_000;
            // 4 ms, and up to 6 ms more; the first 4 ms come at once.
            let at = START_NS + board_us * 1000 + 4_000_000 + (tick % 7) * 1_000_000;
            let host = clock.host_ns(HostNs(at), board_us).0;
            assert_eq!(host, START_NS + board_us * 1000 + 4_000_000);
            assert!(host <= at && host >= last);
            last = host;
        }
    }

    #[test]
    fn a_board_whose_clock_is_slow_is_followed() {
        let mut clock = BoardClock::default();
        for tick in 0..100_000_u64 {
            let at = START_NS + tick * 10_001_000;
            let host = clock.host_ns(HostNs(at), tick * 10_000).0;
            // 100 ppm in 20 s.
            assert!(at - host <= 2_100_000, "{} ns at tick {tick}", at - host);
        }
    }

    #[test]
    fn a_restart_begins_anew() {
        let mut clock = BoardClock::default();
        clock.host_ns(HostNs(START_NS), 5_000_000);
        assert_eq!(clock.host_ns(HostNs(START_NS + 7), 0), HostNs(START_NS + 7));
    }
}
