//! The board's time on the host's clock.

use std::collections::VecDeque;

use serde::Serialize;

use crate::clock::HostNs;

/// Length of a block, in which the sample of the shortest delay is selected, ns; two crystals drift by less than 1 ms in it.
const BLOCK_NS: u64 = 10_000_000_000;

/// Blocks over which the drift is estimated: ten minutes.
const BLOCKS: usize = 60;
/// Fewest blocks for an estimate of the drift.
const MIN_BLOCKS: usize = 4;

/// Maps the time stamps of a board to the host's clock.
///
/// The delay of a message varies, and is never below some milliseconds. The offset of the clocks is that of the message with
/// the shortest delay in the last ten to twenty seconds, as in the clock filter of NTP. No mapped time is later than the
/// arrival.
#[derive(Debug, Default)]
pub struct ClockSync {
    block_start: u64,
    /// Sample of the shortest delay in this block, and the difference of host and board, ns, of the one before.
    min_delay: Option<MinDelaySample>,
    min_before: Option<i64>,
    last_us: u64,
    /// Samples of the shortest delay of the complete blocks.
    blocks: VecDeque<MinDelaySample>,
}

/// The message with the shortest delay.
#[derive(Debug, Clone, Copy)]
struct MinDelaySample {
    board_ns: i64,
    difference_ns: i64,
}

/// Drift of the board's clock against the host's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClockDrift {
    /// Rate by which the board's clock is faster than the host's, ppm.
    pub board_ppm: f64,
    /// Standard error of the rate, ppm.
    pub error_ppm: f64,
    /// Time over which it was estimated, s.
    pub seconds: f64,
}

impl ClockSync {
    /// Host time of the board's time stamp `board_us` in a message that arrived at `at`.
    pub fn host_ns(&mut self, at: HostNs, board_us: u64) -> HostNs {
        if board_us < self.last_us {
            // The board has restarted.
            *self = Self::default();
        }
        self.last_us = board_us;
        if at.0.saturating_sub(self.block_start) > BLOCK_NS {
            self.begin_block(at);
        }
        let board_ns = board_us.saturating_mul(1000) as i64;
        let here = MinDelaySample { board_ns, difference_ns: (at.0 as i64).saturating_sub(board_ns) };
        let min = self.min_delay.filter(|min| min.difference_ns <= here.difference_ns).unwrap_or(here);
        self.min_delay = Some(min);
        let difference_ns = self.min_before.map_or(min.difference_ns, |before| before.min(min.difference_ns));
        HostNs(board_ns.saturating_add(difference_ns).max(0) as u64)
    }

    fn begin_block(&mut self, at: HostNs) {
        self.block_start = at.0;
        let min = self.min_delay.take();
        self.min_before = min.map(|min| min.difference_ns);
        if self.blocks.len() == BLOCKS {
            self.blocks.pop_front();
        }
        self.blocks.extend(min);
    }

    /// Drift of the clocks: the regression line through the shortest delays of the last ten minutes. `None` before there are
    /// enough blocks.
    #[must_use]
    pub fn drift(&self) -> Option<ClockDrift> {
        let (first, last) = (self.blocks.front()?, self.blocks.back()?);
        let count = self.blocks.len() as f64;
        if self.blocks.len() < MIN_BLOCKS {
            return None;
        }
        // Relative to the first block, s, so that no digits are lost.
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
        // The difference grows where the board is slow.
        let seconds = (last.board_ns - first.board_ns) as f64 * 1e-9;
        Some(ClockDrift { board_ppm: -slope * 1e6, error_ppm: error * 1e6, seconds })
    }
}

#[cfg(test)]
mod tests {
    use super::{ClockSync, HostNs};

    /// 10⁹ s after 1970.
    const START_NS: u64 = 1_000_000_000_000_000_000;

    #[test]
    fn jitter_of_the_line_is_removed() {
        let mut clock = ClockSync::default();
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
        let mut clock = ClockSync::default();
        for tick in 0..100_000_u64 {
            let at = START_NS + tick * 10_001_000;
            let host = clock.host_ns(HostNs(at), tick * 10_000).0;
            // 100 ppm in 20 s.
            assert!(at - host <= 2_100_000, "{} ns at tick {tick}", at - host);
        }
    }

    #[test]
    fn the_drift_of_a_slow_board_is_estimated_through_jitter_after_a_minute() {
        let mut clock = ClockSync::default();
        for tick in 0..6000_u64 {
            // 100 ppm slow, 0 to 6.7 ms late in no pattern.
            let late_ns = (tick * 2_654_435_761 % 67) * 100_000;
            clock.host_ns(HostNs(START_NS + tick * 10_001_000 + late_ns), tick * 10_000);
            assert!(tick > 3900 || clock.drift().is_none(), "at tick {tick}");
        }
        let drift = clock.drift().expect("a minute is enough");
        assert!((drift.board_ppm + 100.0).abs() < 5.0 && drift.error_ppm < 5.0, "{drift:?}");
        assert!((30.0..60.0).contains(&drift.seconds), "{drift:?}");
    }

    #[test]
    fn a_restart_resets_the_offset() {
        let mut clock = ClockSync::default();
        clock.host_ns(HostNs(START_NS), 5_000_000);
        assert_eq!(clock.host_ns(HostNs(START_NS + 7), 0), HostNs(START_NS + 7));
    }
}
