//! Sessions of arms that other simulators made.

use std::fmt::{self, Write};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use calibration_tables::ArmFile;
use flate2::read::GzDecoder;
use host_tests::contact::alarms;
use host_tests::parallel::in_parallel;
use proprio_session::{LoadedTable, Row, SessionReader};

use crate::arm::{Problem, RATE_HZ, Tables};
use crate::evaluation::{Evaluation, Figures};
use crate::family::write_summary;

const SESSIONS: [&str; 3] = ["s1", "s2", "s3"];
/// A session with long rests, of one rig.
const RESTS: &str = "rests";

/// Sessions in which nothing touches the arm.
const FREE: [&str; 2] = ["s1", RESTS];

/// Figures of one rig.
struct Rig {
    name: String,
    maps_rmse_deg: f64,
    sessions: Vec<Figures>,
    rests: Option<Figures>,
    /// False alarms in the free session and the rests, and their seconds.
    false_alarms: usize,
    free_s: f64,
}

/// Figures of all rigs.
pub struct Rigs {
    rigs: Vec<Rig>,
}

impl Rigs {
    /// `None` where the rigs are not there.
    pub fn measure(arm: &ArmFile, root: &Path, folder: &Path) -> Result<Option<Self>, Problem> {
        let rigs = root.join("../shared/rigs");
        if !rigs.is_dir() {
            eprintln!("no ../shared/rigs next to the checkout: its section stays empty");
            return Ok(None);
        }
        let mut paths: Vec<PathBuf> = fs::read_dir(&rigs)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
        paths.retain(|path| path.is_dir());
        paths.sort();
        let rigs = in_parallel(&paths, |path| Rig::measure(arm, path, folder));
        Ok(Some(Self { rigs: rigs.into_iter().collect::<Result<_, _>>()? }))
    }

    /// Of each rig: name, false alarms in its free sessions, and their seconds.
    pub fn false_alarms(&self) -> impl Iterator<Item = (&str, usize, f64)> {
        self.rigs.iter().map(|rig| (rig.name.as_str(), rig.false_alarms, rig.free_s))
    }

    /// Writes the table, or why it is missing.
    pub fn write(rigs: Option<&Self>, page: &mut String) -> fmt::Result {
        writeln!(page, "{RIGS}")?;
        let Some(Self { rigs }) = rigs else {
            return writeln!(page, "The sessions were not there when this page was made.\n");
        };
        writeln!(
            page,
            "| rig | map RMSE | I | II | III | smoothed: I | II | III | paper's method: I | II | III | best raw: I | II | III |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")?;
        for rig in rigs {
            write!(page, "| {} | {:.1}° |", rig.name, rig.maps_rmse_deg)?;
            rig.sessions.iter().try_for_each(|figures| write!(page, " {} |", figures.fusion_and_inside()))?;
            rig.sessions.iter().try_for_each(|figures| write!(page, " {} |", figures.smoothed_and_inside()))?;
            rig.sessions.iter().try_for_each(|figures| write!(page, " {:.1} |", figures.paper_mm))?;
            rig.sessions.iter().try_for_each(|figures| write!(page, " {:.1} |", figures.raw_mm))?;
            writeln!(page)?;
        }
        for (rig, rests) in rigs.iter().filter_map(|rig| Some((rig, rig.rests?))) {
            let Figures { paper_mm, raw_mm, .. } = rests;
            writeln!(
                page,
                "| {}, rests | | {} | | | {} | | | {paper_mm:.1} | | | {raw_mm:.1} | | |",
                rig.name,
                rests.fusion_and_inside(),
                rests.smoothed_and_inside()
            )?;
        }
        writeln!(
            page,
            "\n| | fusion | worst | inside | lowest | NEES | flagged | smoothed | worst | inside | lowest | paper's method | best raw |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|---|---|---|")?;
        let all: Vec<Figures> = rigs.iter().flat_map(|rig| rig.sessions.iter().copied()).collect();
        write_summary(page, &format!("all {}", all.len()), &all)?;
        writeln!(page)
    }
}

impl Rig {
    fn measure(arm: &ArmFile, path: &Path, folder: &Path) -> Result<Self, Problem> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        eprintln!("{name}");
        let tables = Tables::of_sweep(&unpacked(path, "sweep", folder)?, arm)?;
        let (mut false_alarms, mut free_s) = (0, 0.0);
        let mut figures = |session: &str| -> Result<Figures, Problem> {
            let (rate_hz, rows) = rows(&unpacked(path, session, folder)?, &tables)?;
            let evaluation = Evaluation::of(&tables, rate_hz, || rows.iter().cloned())?;
            if FREE.contains(&session) {
                false_alarms += alarms(&evaluation.contact);
                free_s += rows.len() as f64 / rate_hz;
            }
            Ok(evaluation.figures())
        };
        let sessions = SESSIONS.iter().map(|session| figures(session)).collect::<Result<_, _>>()?;
        let rests = path.join(format!("{RESTS}.csv.gz")).exists().then(|| figures(RESTS)).transpose()?;
        Ok(Self { name, maps_rmse_deg: tables.maps_rmse_deg, sessions, rests, false_alarms, free_s })
    }
}

/// Unpacks a session of a rig.
fn unpacked(rig: &Path, session: &str, folder: &Path) -> Result<PathBuf, Problem> {
    let name = rig.file_name().unwrap_or_default().to_string_lossy();
    let to = folder.join(format!("{name}-{session}.csv"));
    let packed = rig.join(format!("{session}.csv.gz"));
    let from = File::open(&packed).map_err(|error| format!("{}: {error}", packed.display()))?;
    io::copy(&mut GzDecoder::new(from), &mut File::create(&to)?)?;
    Ok(to)
}

/// Reads all rows, and their rate.
fn rows(session: &Path, tables: &Tables) -> Result<(f64, Vec<Row>), Problem> {
    let needs = LoadedTable { file: tables.own.clone(), path: session }.required_columns()?;
    let mut reader = SessionReader::open(session, &needs)?;
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row()? {
        rows.push(row);
    }
    Ok((reader.rate_hz(RATE_HZ)?, rows))
}

const RIGS: &str = "\
## Arms of other simulators

Two programs that share nothing with `rig-twin`: four elastic rods of 60 hinges with friction, post and stick, whose strips are nonlinear,
hysteretic, creep and drift with temperature, and two arms by formula. As calibrated on their sweeps. Tip RMSE of fusion in mm (share of
true tips inside the 95 % ellipse); then of the [smoothed](smoothing.md) estimates, of the paper's method on the same sweep, and of the better of bend sensors and raw IMUs. No
constant was chosen on them.
";
