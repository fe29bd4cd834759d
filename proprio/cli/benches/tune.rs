//! Tuning on the paper's training session, 40 000 samples at 10 Hz, six segments: `cargo bench --package proprio`.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use calibration_tables::ArmFile;
use divan::Bencher;
use divan::counter::ItemsCount;
use proprio_calibration::tune::Tuner;
use proprio_session::{Existing, LoadedTable, NoProgress, OutputFile};
use proprio_simulation::{ImuColumns, SessionWriter, Simulation};
use rig_twin::{Layout, Scenario};

const SECONDS: f64 = 4000.0;
const RATE_HZ: f64 = 10.0;
const ITERATIONS: u64 = 10;

static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();

fn main() {
    divan::main();
}

/// The session, simulated at its first use.
fn session() -> PathBuf {
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = OutputFile::create(&folder.path().join("session.csv"), &[], Existing::Keep).expect("a session file");
        let mut writer = SessionWriter::new(file, &Layout::default(), ImuColumns::Deg).expect("room on the disk");
        for sample in Simulation::new(Scenario::FreeSwing, 7, SECONDS, RATE_HZ).expect("a valid run") {
            writer.write(&sample).expect("room on the disk");
        }
        writer.into_inner().finish().expect("room on the disk");
        folder
    });
    folder.path().join("session.csv")
}

fn table() -> LoadedTable<'static> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml"));
    LoadedTable { file: ArmFile::load(path).expect("the reference table"), path }
}

/// From the files to the table: reading, the search for an observer, descent until it converges, and the variances.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn until_it_converges(bencher: Bencher) {
    let (sessions, table) = ([session()], table());
    bencher.bench_local(|| {
        let tuner = Tuner::new(&sessions, &table, &mut NoProgress).expect("a good session");
        tuner.tune(&mut NoProgress, || false).expect("errors that are numbers").record.iterations
    });
}

/// Iterations of the descent, and what stands before and after it; items are iterations. With the anchor: no observer is
/// searched for.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn iterations(bencher: Bencher) {
    let (sessions, mut table) = ([session()], table());
    (table.file.drift, table.file.uncertainty) = (None, None);
    let tuner = || Tuner::new(&sessions, &table, &mut NoProgress).expect("a good session");
    bencher.counter(ItemsCount::new(ITERATIONS)).with_inputs(tuner).bench_local_values(|tuner| {
        let calls = Cell::new(0);
        let is_over = || calls.replace(calls.get() + 1) == ITERATIONS;
        let record = tuner.tune(&mut NoProgress, is_over).expect("errors that are numbers").record;
        assert_eq!(record.iterations, ITERATIONS);
    });
}
