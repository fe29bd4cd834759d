//! A run of the twin as a rig records it: the sensors' session, and the camera's file by its own clock.

use std::sync::OnceLock;

use super::common::{Csv, Folder, Run, arm};

/// Time of the twin's camera at time 0 of the rig's clock, s, and the share by which it is faster.
const TWIN_AHEAD_S: f64 = 1_760_000_000.0;
const TWIN_FAST: f64 = 80e-6;

/// A session without truth and its camera's file.
#[derive(Clone)]
pub struct Recording {
    pub session: Csv,
    pub camera: Csv,
}

impl Recording {
    /// The files that `simulate --camera` writes with these arguments.
    pub fn simulate(args: &str) -> Self {
        let folder = Folder::new();
        let mut all = vec!["simulate", "-o", "session.csv", "--camera", "camera.csv"];
        all.extend(args.split(' '));
        folder.done(&all);
        Self { session: folder.csv("session.csv"), camera: folder.csv("camera.csv") }
    }

    /// 300 s of free swings at 10 Hz.
    pub fn short() -> Self {
        static RECORDING: OnceLock<Recording> = OnceLock::new();
        RECORDING.get_or_init(|| Self::simulate("--scenario 1 --seconds 300 --seed 71")).clone()
    }

    /// 900 s of free swings at 10 Hz.
    pub fn long() -> Self {
        static RECORDING: OnceLock<Recording> = OnceLock::new();
        RECORDING.get_or_init(|| Self::simulate("--scenario 1 --seconds 900 --seed 72")).clone()
    }

    /// The camera's times by another clock: `offset_s` ahead at the session's 0, and faster by `ppm`.
    pub fn with_clock(mut self, offset_s: f64, ppm: f64) -> Self {
        self.retime(|time_s| offset_s + time_s * (1.0 + ppm * 1e-6));
        self
    }

    /// The camera's times as `clock` has them at each time of the session.
    pub fn retime(&mut self, clock: impl Fn(f64) -> f64) {
        self.camera.map("time_s", |_, text| format!("{:.6}", clock(true_s(text))));
    }

    /// Keeps the frames that were taken within these times of the session.
    pub fn keep_frames(&mut self, within: impl Fn(f64) -> bool) {
        let time = self.camera.column("time_s");
        self.camera.rows.retain(|row| within(true_s(&row[time])));
    }

    /// Keeps the samples of these times.
    pub fn keep_samples(&mut self, within: impl Fn(f64) -> bool) {
        let time = self.session.column("time_s");
        self.session.rows.retain(|row| within(row[time].parse().expect("a time")));
    }

    pub fn folder(&self) -> Folder {
        let folder = Folder::with("session.csv", self.session.to_string());
        folder.write("camera.csv", self.camera.to_string());
        folder
    }

    pub fn align(&self) -> Aligned {
        Aligned::of(self.folder())
    }

    /// The error of an alignment that must be refused.
    pub fn refused(&self) -> String {
        self.folder().refused(&args(arm()))
    }
}

/// The time of the session at which a frame of the twin's camera was taken.
fn true_s(camera_s: &str) -> f64 {
    (camera_s.parse::<f64>().expect("a time") - TWIN_AHEAD_S) / (1.0 + TWIN_FAST)
}

/// The command that aligns a folder's `session.csv`.
pub fn args(arm: &str) -> [&str; 8] {
    ["align", "session.csv", "--camera", "camera.csv", "--arm", arm, "-o", "aligned.csv"]
}

/// A session that was aligned.
pub struct Aligned {
    pub folder: Folder,
    pub run: Run,
}

impl Aligned {
    pub fn of(folder: Folder) -> Self {
        let run = folder.done(&args(arm()));
        Self { folder, run }
    }

    pub fn csv(&self) -> Csv {
        self.folder.csv("aligned.csv")
    }

    /// The numbers of one line of the report.
    pub fn numbers(&self, line: &str) -> Vec<f64> {
        let found = self.run.stdout.lines().find_map(|text| text.strip_prefix(line));
        let found = found.unwrap_or_else(|| panic!("no {line} in {}", self.run.stdout));
        found.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
    }

    /// Error of the offset for a clock as of [`Recording::with_clock`], ms.
    pub fn offset_error_ms(&self, offset_s: f64, ppm: f64) -> f64 {
        let [found_s, _, at_s] = self.numbers("offset")[..] else { panic!("{}", self.run.stdout) };
        (found_s - offset_s - at_s * ppm * 1e-6) * 1e3
    }

    pub fn skew_ppm(&self) -> f64 {
        self.numbers("skew")[0]
    }
}
