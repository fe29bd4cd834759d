//! A session of 45 min at 100 Hz through all four methods, reading included: `cargo bench --package proprio`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use calibration_tables::ArmFile;
use divan::Bencher;
use divan::counter::ItemsCount;
use estimator_core::{Q, Scalar};
use proprio::output::OutputFile;
use proprio::replay::{NamedTable, replay};
use proprio::score::Score;
use proprio::session::{ImuColumns, SessionWriter};
use proprio::simulate::Simulation;
use rig_twin::Scenario;

const SECONDS: f64 = 2700.0;
const RATE_HZ: f64 = 100.0;
const SAMPLES: u64 = 270_000;

static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();

fn main() {
    divan::main();
    if let Some(peak) = peak_memory() {
        println!("peak memory: {peak}");
    }
}

/// The session, simulated when it is first asked for.
fn session() -> PathBuf {
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = OutputFile::create(&folder.path().join("session.csv"), &[]).expect("a session file");
        let mut writer = SessionWriter::new(file, ImuColumns::Deg).expect("room on the disk");
        for sample in Simulation::new(Scenario::One, 1, SECONDS, RATE_HZ).expect("a valid run") {
            writer.write(&sample).expect("room on the disk");
        }
        writer.into_inner().finish().expect("room on the disk");
        folder
    });
    folder.path().join("session.csv")
}

fn table() -> NamedTable<'static> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../calibration-tables/planar-6.toml"));
    NamedTable { file: ArmFile::load(path).expect("the reference table"), path }
}

fn replays<S: Scalar>(bencher: Bencher) {
    let (session, table) = (session(), table());
    bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
        let mut score = Score::new(table.file.length_mm());
        let extent = replay::<S>(&session, &table, |row, outcome| {
            score.add(row, outcome);
            Ok(())
        });
        assert_eq!(extent.expect("a good session").samples, SAMPLES);
        score.figures()
    });
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn fixed_point(bencher: Bencher) {
    replays::<Q>(bencher);
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn float(bencher: Bencher) {
    replays::<f64>(bencher);
}

/// The process's peak resident memory, where the system tells.
fn peak_memory() -> Option<String> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    Some(status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().to_owned())
}
