//! The drift of a real IMU on simulated headings.

use std::array::from_fn;
use std::fmt::{self, Write};
use std::path::Path;

use host_tests::parallel::in_parallel;
use host_tests::twin::TwinSession;
use rig_twin::{HeadingDrift, Motion, SEGMENTS};

use crate::arm::{Problem, RATE_HZ, SESSION_S, read, setup};
use crate::evaluation::{Evaluation, Figures};
use crate::family::{Family, SCENARIOS};

const ARMS: [u64; 2] = [101, 102];
/// Recordings of the file; IMUs 1 to 3 use them as they are, IMUs 4 to 6 mirrored.
const RECORDINGS: [&str; 3] = ["02", "05", "10"];
/// The paper's drift over a session.
const SCALED_DEG: f64 = 45.0;

/// Figures with the recorded drift, as it is and scaled.
pub struct RealDrift {
    rows: Vec<(u64, &'static str, [Figures; 2])>,
}

impl RealDrift {
    /// `None` where the recording is not there.
    pub fn measure(family: &Family, root: &Path) -> Result<Option<Self>, Problem> {
        let path = root.join("../shared/data/broad-heading-error.csv");
        if !path.exists() {
            eprintln!("no ../shared/data/broad-heading-error.csv next to the checkout: its section stays empty");
            return Ok(None);
        }
        let csv = read(&path)?;
        let drifts = [drifts(&csv, false)?, drifts(&csv, true)?];
        let jobs: Vec<(u64, usize)> = ARMS.into_iter().flat_map(|seed| [0, 1].map(|k| (seed, k))).collect();
        let rows = in_parallel(&jobs, |(seed, k)| -> Result<_, Problem> {
            let (name, scenario) = SCENARIOS[*k];
            let session = TwinSession::new(&setup(*seed, scenario, Motion::Swings), SESSION_S, RATE_HZ)?;
            let figures = |drifts: &[HeadingDrift; SEGMENTS]| {
                let samples = session.samples.iter().map(|sample| sample.clone().with_drift(drifts)).collect();
                Evaluation::of_twin(family.tables(*seed)?, &TwinSession { samples, ..session.clone() })
                    .map_err(Problem::from)
            };
            Ok((*seed, name, [figures(&drifts[0])?.figures(), figures(&drifts[1])?.figures()]))
        });
        Ok(Some(Self { rows: rows.into_iter().collect::<Result<_, _>>()? }))
    }

    /// Writes the table, or why it is missing.
    pub fn write(drift: Option<&Self>, family: &Family, page: &mut String) -> fmt::Result {
        writeln!(page, "{DRIFT}")?;
        let Some(drift) = drift else {
            return writeln!(page, "The recordings were not there when this page was made.\n");
        };
        writeln!(
            page,
            "| arm | scenario | none added | paper | as it is | paper | raw | 45° in 15 min | paper | raw |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|")?;
        for (seed, scenario, added) in &drift.rows {
            let k = SCENARIOS.iter().position(|(name, _)| name == scenario);
            let Some(clean) = k.and_then(|k| Some(family.arm(*seed)?.scenarios[k])) else { continue };
            write!(page, "| {seed} | {scenario} | {} | {:.1} |", clean.fusion_and_inside(), clean.paper_mm)?;
            for figures in added {
                write!(page, " {} | {:.1} | {:.1} |", figures.fusion_and_inside(), figures.paper_mm, figures.raw_mm)?;
            }
            writeln!(page)?;
        }
        writeln!(page)
    }
}

/// The drift of each IMU; scaled, each is off by 45° at the session's end.
fn drifts(csv: &str, scaled: bool) -> Result<[HeadingDrift; SEGMENTS], Problem> {
    let parse = |recording, factor| {
        HeadingDrift::parse(csv, recording, factor).ok_or_else(|| format!("recording {recording} is not in the file"))
    };
    let mut each = Vec::new();
    for recording in RECORDINGS {
        let drifted_deg = parse(recording, 1.0)?.at(SESSION_S).to_degrees().abs();
        let factor = if scaled { SCALED_DEG / drifted_deg } else { 1.0 };
        each.push([parse(recording, factor)?, parse(recording, -factor)?]);
    }
    Ok(from_fn(|imu| each[imu % RECORDINGS.len()][imu / RECORDINGS.len()].clone()))
}

const DRIFT: &str = "\
## The drift of a real IMU

The heading error of a real IMU's 6-axis filter against optical truth (recordings 02, 05 and 10 of
[BROAD](https://github.com/dlaidig/broad), D. Laidig et al., CC BY 4.0, computed with the VQF filter), added to the simulated headings of
two test arms and their own drift: IMUs 1 to 3 have the recordings as they are, IMUs 4 to 6 mirrored; a recording of some 190 s repeats
and continues where it ended. Scaled, each heading is off by 45° after 15 min, as in the paper.
";
