//! Recordings that begin while the board runs: their replay begins with the state of the board's estimator, or says that it does
//! not.

use std::path::{Path, PathBuf};
use std::process::Command;

use calibration_tables::{ArmFile, CompiledTable};
use estimator_core::{Estimator, Method, Q};
use proprio_link::{FileRecorder, Link};
use proprio_session::{HostClock, SessionReader};
use proprio_simulation::Simulation;
use rig_twin::Scenario;
use serde_json::Value;
use telemetry::{Estimate, Message, Sample, TICK_HZ};

use super::http::Page;
use super::line::{Line, hello, wait_for};

/// Segments of the reference arm.
const SEGMENTS: usize = 6;

pub fn table() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml")
}

/// Sends the samples and the estimates of a board with the reference table, which is tared at `tare`.
pub struct Arm<'t> {
    simulation: Simulation,
    estimator: Box<Estimator<'t, Q, SEGMENTS, 100>>,
    tare: u32,
    tick: u32,
}

impl<'t> Arm<'t> {
    pub fn new(config: &'t estimator_core::ArmConfig<'t, Q>, tare: u32) -> Self {
        let simulation = Simulation::new(Scenario::Push, 7, 60.0, TICK_HZ).expect("a valid run");
        let estimator = Box::new(Estimator::new(config).expect("the reference table"));
        Self { simulation, estimator, tare, tick: 0 }
    }

    pub fn run(&mut self, line: &Line, ticks: u32) {
        for _ in 0..ticks {
            let read = self.simulation.next().expect("the run is long");
            if self.tick == self.tare {
                self.estimator.start().expect("the reference table");
            }
            let tare_epoch = u8::from(self.tick >= self.tare);
            let time_us = u64::from(self.tick) * 10_000;
            let sample = Sample { tick: self.tick, time_us, tare_epoch, bend: read.counts, imu: read.quaternions };
            let estimate = self.estimator.update_full(&(&sample).into());
            let shape = self.estimator.shape(&estimate, Method::Fusion);
            let mut board = line.board();
            board.send(&Message::Sample(sample));
            board.send(&Message::Estimate(Estimate::of(self.tick, &shape)));
            drop(board);
            self.tick += 1;
        }
    }
}

pub fn compiled() -> CompiledTable<Q> {
    ArmFile::load(&table()).and_then(|file| file.compile::<Q>(TICK_HZ)).expect("the reference table")
}

/// Records `ticks` of a running arm from the page; returns the file.
fn recorded(page: &Page, line: &Line, arm: &mut Arm<'_>, ticks: u32) -> (PathBuf, Value) {
    assert_eq!(page.post("/record", r#"{"on":true}"#).status, 200);
    line.board().send(&Message::Hello(hello(1)));
    arm.run(line, ticks);
    page.wait_for_status(|status| status["recording"]["samples"].as_u64() >= Some(u64::from(ticks) - 1));
    let done: Value = serde_json::from_slice(&page.post("/record", r#"{"on":false}"#).body).expect("JSON");
    (PathBuf::from(done["file"].as_str().expect("a name")), done)
}

/// Figures of `proprio replay --json` and its standard error.
pub fn replayed(file: &Path) -> (Value, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_proprio"));
    let run = command.arg("replay").arg(file).arg("--table").arg(table()).arg("--json").output().expect("it starts");
    let stderr = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.success(), "{stderr}");
    let report: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    (report["sessions"][0].clone(), stderr)
}

#[test]
fn a_recording_that_begins_long_after_the_tare_is_replayed_bit_for_bit_from_its_first_sample() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let page = Page::of(&line, None);
    let mut arm = Arm::new(&config, 150);
    line.board().restart(1);
    arm.run(&line, 1500);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 1500);
    let (file, progress) = recorded(&page, &line, &mut arm, 600);
    assert_eq!(progress["is_comparable"], true);

    let (session, stderr) = replayed(&file);
    let recorded = &session["recorded"];
    // The history is no part of the session.
    assert_eq!((&session["samples"], &recorded["estimates"]), (&600.into(), &600.into()), "{stderr}");
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&600.into(), &0.into()), "{stderr}");
    assert!(!stderr.contains("cannot be compared"), "{stderr}");
}

/// The same file without its history is one of an earlier version.
#[test]
fn a_recording_without_its_tare_is_named_and_neither_compared_nor_shown_with_drift() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let mut arm = Arm::new(&config, 150);
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    line.board().restart(1);
    arm.run(&line, 1500);
    let is_last = |tick: u32| {
        wait_for(&events, |kind| {
            matches!(kind, proprio_link::EventKind::Message(Message::Estimate(of)) if of.tick == tick).then_some(())
        });
    };
    is_last(1499);
    let folder = tempfile::tempdir().expect("there is room for a temporary folder");
    let file = folder.path().join("late.mcap");
    let mut recorder = FileRecorder::create(&file, &link, HostClock::new(), None).expect("a new file");
    let events_of_file = link.subscribe();
    arm.run(&line, 600);
    is_last(2099);
    recorder.remaining_events(&events_of_file).expect("there is room");
    recorder.finish().expect("there is room");

    let (session, stderr) = replayed(&file);
    let recorded = &session["recorded"];
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&0.into(), &600.into()), "{stderr}");
    assert!(stderr.contains("warning: ") && stderr.contains("600 of 600 samples cannot be compared"), "{stderr}");
    assert!(stderr.contains("none of the 600 recorded estimates can be compared"), "{stderr}");
    assert!(!stderr.contains("bit for bit"), "{stderr}");

    let table = table();
    let loaded = proprio_session::LoadedTable::load(&table).expect("the reference table");
    let page = Page::with_table(&Line::new(), None, Some(loaded));
    std::fs::copy(&file, page.folder.path().join("late.mcap")).expect("there is room");
    let columns = page.socket(Some(&page.origin())).expect("its own page").next("arm")["columns"].clone();
    let shown = page.get("/session?name=late.mcap");
    for name in ["drift6_deg", "innovation_imu2_deg", "innovation_bend3_deg"] {
        assert!(shown.column(&columns, name).iter().all(|bits| f32::from_bits(*bits).is_nan()), "{name}");
    }
    assert!(shown.column(&columns, "x6_mm").iter().all(|bits| !f32::from_bits(*bits).is_nan()), "the board's estimate");
}

#[test]
fn a_sample_lost_since_the_tare_is_said_when_the_recording_begins() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let page = Page::of(&line, None);
    let mut arm = Arm::new(&config, 150);
    line.board().restart(1);
    arm.run(&line, 300);
    arm.run(&Line::new(), 1);
    line.board().lose_frame();
    arm.run(&line, 300);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 600);
    let (file, progress) = recorded(&page, &line, &mut arm, 100);
    assert_eq!(progress["is_comparable"], false);
    let (session, stderr) = replayed(&file);
    assert_eq!(session["recorded"]["not_compared"], 100, "{stderr}");
}

#[test]
fn a_tare_within_the_recording_is_where_the_comparison_begins_without_a_history() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let page = Page::of(&line, None);
    let mut arm = Arm::new(&config, 500);
    line.board().restart(1);
    arm.run(&Line::new(), 400);
    arm.run(&line, 10);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 10);
    let (file, _) = recorded(&page, &line, &mut arm, 300);
    let (session, stderr) = replayed(&file);
    let recorded = &session["recorded"];
    // Ticks 410 to 499 are before the tare.
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&210.into(), &90.into()), "{stderr}");
    assert!(stderr.contains("90 of 300 samples cannot be compared"), "{stderr}");
}

#[test]
fn a_csv_of_a_recording_has_the_samples_since_the_tare() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let page = Page::of(&line, None);
    let mut arm = Arm::new(&config, 150);
    line.board().restart(1);
    arm.run(&line, 1000);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 1000);
    let (file, _) = recorded(&page, &line, &mut arm, 200);
    let csv = page.folder.path().join("late.csv");
    let mut command = Command::new(env!("CARGO_BIN_EXE_proprio"));
    let run = command.arg("convert").arg(&file).arg(&csv).output().expect("it starts");
    let stderr = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && stderr.contains("rows are from before the begin of the recording"), "{stderr}");
    let needs = proprio_session::RequiredColumns { bend: vec![None; SEGMENTS], truth: false };
    let mut reader = SessionReader::open(&csv, &needs).expect("a session");
    let mut times_us = Vec::new();
    while let Some(row) = reader.next_row().expect("a session") {
        if row.starts {
            times_us.clear();
        }
        times_us.push(row.sample.time_us);
    }
    assert_eq!((times_us[0], times_us.len()), (1_500_000, 1050), "from the tare to the end");
}
