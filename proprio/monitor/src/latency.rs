//! Latency from a sample to the screen.

use std::collections::VecDeque;

use serde::Serialize;

/// Number of reports that are kept: those of the last minute and more.
const CAPACITY: usize = 3000;

/// Latencies of the last samples.
#[derive(Debug, Default)]
pub(super) struct Latency {
    reports_us: VecDeque<u64>,
}

/// A distribution, ms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Percentiles {
    reports: usize,
    p5_ms: f64,
    p50_ms: f64,
    p95_ms: f64,
    p99_ms: f64,
    largest_ms: f64,
}

impl Latency {
    pub fn push(&mut self, latency_us: u64) {
        if self.reports_us.len() == CAPACITY {
            self.reports_us.pop_front();
        }
        self.reports_us.push_back(latency_us);
    }

    /// Percentiles of the latencies; `None` before the first report.
    pub fn percentiles(&self) -> Option<Percentiles> {
        let mut sorted: Vec<u64> = self.reports_us.iter().copied().collect();
        sorted.sort_unstable();
        let last = sorted.len().checked_sub(1)?;
        let at = |percent: usize| sorted[last * percent / 100] as f64 / 1e3;
        Some(Percentiles {
            reports: sorted.len(),
            p5_ms: at(5),
            p50_ms: at(50),
            p95_ms: at(95),
            p99_ms: at(99),
            largest_ms: at(100),
        })
    }
}
