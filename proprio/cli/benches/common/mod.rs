//! Common parts of the benchmarks: long sessions of the twin at 100 Hz, the reference table, and the peak of the memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use calibration_tables::ArmFile;
use proprio_session::{Existing, LoadedTable, OutputFile};
use proprio_simulation::{ImuColumns, SessionWriter, Simulation};
use rig_twin::{Layout, Scenario};

static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();

/// A session of free swings, simulated at its first use.
pub fn session(seconds: u32, rate_hz: u32) -> PathBuf {
    let folder = FOLDER.get_or_init(|| tempfile::tempdir().expect("a temporary folder"));
    let path = folder.path().join(format!("{seconds}-s-at-{rate_hz}-Hz.csv"));
    if !path.exists() {
        let file = OutputFile::create(&path, &[], Existing::Keep).expect("a session file");
        let mut writer = SessionWriter::new(file, &Layout::default(), ImuColumns::Deg).expect("room on the disk");
        let run = Simulation::new(Scenario::FreeSwing, 1, f64::from(seconds), f64::from(rate_hz)).expect("a valid run");
        for sample in run {
            writer.write(&sample).expect("room on the disk");
        }
        writer.into_inner().finish().expect("room on the disk");
    }
    path
}

pub fn table() -> LoadedTable<'static> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml"));
    LoadedTable { file: ArmFile::load(path).expect("the reference table"), path }
}

/// Prints the process's peak resident memory during `work`, where the system reports it.
pub fn print_peak(what: &str, work: impl FnOnce()) {
    // Linux forgets the peak so far.
    let _ = fs::write("/proc/self/clear_refs", "5");
    work();
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(peak) = status.lines().find_map(|line| line.strip_prefix("VmHWM:")) {
        println!("peak memory, {what}: {}", peak.trim());
    }
}
