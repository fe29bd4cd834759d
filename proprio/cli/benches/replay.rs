//! A session of 45 min at 100 Hz through all four methods, reading included: `cargo bench --package proprio`. Before it, the
//! peak memory of sessions of different length, which must not differ by more than the histograms' growing range.

mod common;

use std::path::Path;

use divan::Bencher;
use divan::counter::ItemsCount;
use estimator_core::{FusedOps, Q};
use proprio_analysis::metrics::{ErrorMetrics, Metrics};
use proprio_analysis::replay::replay;
use proprio_session::NoProgress;

const SECONDS: u32 = 2700;
const RATE_HZ: u32 = 100;

fn main() {
    for seconds in [SECONDS / 100, SECONDS / 10, SECONDS] {
        let session = common::session(seconds, RATE_HZ);
        common::print_peak(&format!("replay of {} samples", seconds * RATE_HZ), || {
            metrics::<Q>(&session, seconds * RATE_HZ);
        });
    }
    divan::main();
}

fn metrics<S: FusedOps>(session: &Path, samples: u32) -> [Metrics; 4] {
    let table = common::table();
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let summary = replay::<S>(session, &table, &mut NoProgress, |row, outcome| {
        errors.add(row, outcome);
        Ok(())
    });
    assert_eq!(summary.expect("a good session").samples, u64::from(samples));
    errors.metrics()
}

fn replays<S: FusedOps>(bencher: Bencher) {
    let (session, samples) = (common::session(SECONDS, RATE_HZ), SECONDS * RATE_HZ);
    bencher.counter(ItemsCount::new(samples)).bench_local(|| metrics::<S>(&session, samples));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn fixed_point(bencher: Bencher) {
    replays::<Q>(bencher);
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn float(bencher: Bencher) {
    replays::<f64>(bencher);
}
