//! The board's time on the host's clock.

use std::collections::VecDeque;

use crate::HostNs;

/// Time over which the shortest delay is looked for, ns; two crystals part by less than 1 ms meanwhile.
const BLOCK_NS: u64 = 10_000_000_000;

/// Blocks that the drift is estimated over: ten minutes.
const BLOCKS: usize = 60;
/// With fewer there is none.
const BLOCKS_LEAST: usize = 4;

/// Relates the time stamps of a board to the times at which they came.
///
/// A message is delayed on its way, sometimes more and never less than some milliseconds: of the last ten to twenty seconds
/// the message with the shortest delay tells how the clocks stand to each other. No time is later than its arrival.
#[derive(Debug, Default)]
pub struct BoardClock {
    block_start: u64,
    /// Least difference of host and board, ns, in this block and the one before.
    least: Option<Least>,
    least_before: Option<i64>,
    last_us: u64,
    /// Of the whole blocks.
    blocks: VecDeque<Least>,
}

/// The message with the shortest delay.
#[derive(Debug, Clone, Copy)]
struct Least {
    board_ns: i64,
    difference_ns: i64,
}

/// How fast two clocks part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// How much faster the board's clock runs than the host's, millionths.
    pub board_ppm: f64,
    /// Standard error of that.
    pub error_ppm: f64,
    /// Time that it was estimated over, s.
    pub seconds: f64,
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
            self.begin_block(at);
        }
        let board_ns = board_us.saturating_mul(1000) as i64;
        let here = Least { board_ns, difference_ns: (at.0 as i64).saturating_sub(board_ns) };
        let least = self.least.filter(|least| least.difference_ns <= here.difference_ns).unwrap_or(here);
        self.least = Some(least);
        let difference_ns = self.least_before.map_or(least.difference_ns, |before| before.min(least.difference_ns));
        HostNs(board_ns.saturating_add(difference_ns).max(0) as u64)
    }

    fn begin_block(&mut self, at: HostNs) {
        self.block_start = at.0;
        let least = self.least.take();
        self.least_before = least.map(|least| least.difference_ns);
        if self.blocks.len() == BLOCKS {
            self.blocks.pop_front();
        }
        self.blocks.extend(least);
    }

    /// How fast the clocks part, once it can be told: the line through the shortest delays of the last ten minutes.
    #[must_use]
    pub fn drift(&self) -> Option<Drift> {
        let (first, last) = (self.blocks.front()?, self.blocks.back()?);
        let count = self.blocks.len() as f64;
        if self.blocks.len() < BLOCKS_LEAST {
            return None;
        }
        // From the first on, in s, so that no digits are lost.
        let points = self.blocks.iter().map(|block| {
            let passed = |now: i64, then: i64| (now - then) as f64 * 1e-9;
            (passed(block.board_ns, first.board_ns), passed(block.difference_ns, first.difference_ns))
        });
        let (sum_x, sum_y) = points.clone().fold((0.0, 0.0), |(x, y), point| (x + point.0, y + point.1));
        let (mean_x, mean_y) = (sum_x / count, sum_y / count);
        let (sxx, sxy, syy) = points.fold((0.0, 0.0, 0.0), |(sxx, sxy, syy), (x, y)| {
            let (x, y) = (x - mean_x, y - mean_y);
            (sxx + x * x, sxy + x * y, syy + y * y)
        });
        let slope = sxy / sxx;
        let error = ((syy - slope * sxy).max(0.0) / (count - 2.0) / sxx).sqrt();
        // The host gains on the board where the board is slow.
        let seconds = (last.board_ns - first.board_ns) as f64 * 1e-9;
        Some(Drift { board_ppm: -slope * 1e6, error_ppm: error * 1e6, seconds })
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
    fn the_drift_of_a_slow_board_is_told_from_jitter_after_a_minute() {
        let mut clock = BoardClock::default();
        for tick in 0..6000_u64 {
            // 100 ppm slow, 0 to 6.7 ms late in no pattern.
            let late_ns = (tick * 2_654_435_761 % 67) * 100_000;
            clock.host_ns(HostNs(START_NS + tick * 10_001_000 + late_ns), tick * 10_000);
            assert!(tick > 3900 || clock.drift().is_none(), "at tick {tick}");
        }
        let drift = clock.drift().expect("a minute tells");
        assert!((drift.board_ppm + 100.0).abs() < 5.0 && drift.error_ppm < 5.0, "{drift:?}");
        assert!((30.0..60.0).contains(&drift.seconds), "{drift:?}");
    }

    #[test]
    fn a_restart_begins_anew() {
        let mut clock = BoardClock::default();
        clock.host_ns(HostNs(START_NS), 5_000_000);
        assert_eq!(clock.host_ns(HostNs(START_NS + 7), 0), HostNs(START_NS + 7));
    }
}
