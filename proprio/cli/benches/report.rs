//! The report of three sessions of 45 min, at 10 Hz and at 100 Hz, reading and drawing included: the aim is under 10 s.
//! Before it, the peak memory at both rates.

mod common;

use divan::Bencher;
use divan::counter::ItemsCount;
use proprio_analysis::report::ReportBuilder;
use proprio_session::NoProgress;

const SECONDS: u32 = 2700;
const RATES_HZ: [u32; 2] = [10, 100];
const SESSIONS: u32 = 3;

fn main() {
    for rate_hz in RATES_HZ {
        common::session(SECONDS, rate_hz);
        common::print_peak(&format!("report of {SESSIONS} × {} samples", SECONDS * rate_hz), || {
            report(rate_hz);
        });
    }
    divan::main();
}

/// Page, JSON and CSV.
fn report(rate_hz: u32) -> [String; 3] {
    let (session, table) = (common::session(SECONDS, rate_hz), common::table());
    let mut gathering = ReportBuilder::new(&table);
    for _ in 0..SESSIONS {
        gathering.add(&session, &mut NoProgress).expect("a good session");
    }
    let report = gathering.finish().expect("a table");
    [report.html(), report.json(), report.csv()]
}

#[divan::bench(args = RATES_HZ, sample_count = 3, sample_size = 1)]
fn three_sessions(bencher: Bencher, rate_hz: u32) {
    let samples = SESSIONS * SECONDS * rate_hz;
    bencher.counter(ItemsCount::new(samples)).bench_local(|| report(rate_hz));
}
