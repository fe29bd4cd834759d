//! The page of results.

use std::fmt::{self, Write};
use std::path::Path;

use estimator_core::Method;
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, NoProgress};

use crate::arm::{Problem, planar};
use crate::contact;
use crate::day::Day;
use crate::family::{DEVELOPMENT, Family, REFERENCE, TEST};
use crate::motions::Motions;
use crate::real_drift::RealDrift;
use crate::rigs::Rigs;

/// The paper's Table I, RMSE mm: I, II, III of bend, imu_o, imu_c and fusion.
const PAPER: [[f64; 3]; 4] =
    [[19.45, 30.10, 29.46], [33.24, 36.68, 22.75], [12.49, 21.88, 22.87], [10.97, 20.24, 23.59]];

/// Everything that the page states.
pub struct Results {
    pub family: Family,
    motions: Motions,
    drift: Option<RealDrift>,
    rigs: Option<Rigs>,
    day: Day,
    /// Tip RMSE of imu_o on the recording of a real arm, mm and % of its length.
    real: Option<[f64; 2]>,
}

impl Results {
    /// Runs everything; sweeps are written in `folder`.
    pub fn measure(root: &Path, folder: &Path) -> Result<Self, Problem> {
        let arm = planar(root)?;
        let family = Family::measure(&arm, folder)?;
        Ok(Self {
            motions: Motions::measure(&family)?,
            drift: RealDrift::measure(&family, root)?,
            rigs: Rigs::measure(&arm, root, folder)?,
            day: Day::measure(&family)?,
            real: real(root)?,
            family,
        })
    }

    /// The page.
    pub fn to_markdown(&self) -> Result<String, fmt::Error> {
        let mut page = String::new();
        writeln!(page, "{INTRODUCTION}")?;
        write_seeds(&mut page)?;
        self.family.write(&mut page)?;
        contact::write(&mut page, &self.family, &self.motions, self.rigs.as_ref())?;
        self.motions.write(&mut page)?;
        RealDrift::write(self.drift.as_ref(), &self.family, &mut page)?;
        Rigs::write(self.rigs.as_ref(), &mut page)?;
        self.day.write(&mut page)?;
        self.write_paper(&mut page)?;
        self.write_real(&mut page)?;
        writeln!(page, "{COMPARED}")?;
        Ok(page)
    }

    fn write_paper(&self, page: &mut String) -> fmt::Result {
        let Some(reference) = self.family.arm(REFERENCE) else { return Ok(()) };
        writeln!(page, "{PAPERS_TABLE}")?;
        writeln!(page, "| method | I | II | III |\n|---|---|---|---|")?;
        for method in [Method::Fusion, Method::Bend, Method::ImuC, Method::ImuO] {
            write!(page, "| {} ", method.name())?;
            for (figures, paper) in reference.paper.iter().zip(PAPER[method as usize]) {
                write!(page, "| {} \\| {paper:.2} ", number(figures[method as usize].tip_rmse_mm))?;
            }
            writeln!(page, "|")?;
        }
        write!(page, "| **fusion, as calibrated** ")?;
        reference.scenarios.iter().try_for_each(|figures| write!(page, "| **{:.2}** ", figures.fusion_mm))?;
        writeln!(
            page,
            "|\n\nMean RMSE of the quadratic V–Orient maps on the sweep: {:.2}° (paper: 4.72°, to which the twin was fitted).\n",
            reference.tables.maps_rmse_deg
        )
    }

    fn write_real(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "## A real arm\n")?;
        match self.real {
            Some([mm, percent]) => writeln!(page, "{REAL_ARM} {mm:.2} mm RMSE,\n{percent:.2} % of its length.\n"),
            None => writeln!(page, "The recording was not there when this page was made.\n"),
        }
    }
}

/// Seeds on which constants were chosen, and seeds on which they are tested.
fn write_seeds(page: &mut String) -> fmt::Result {
    let [development, test] = [&DEVELOPMENT[..], &TEST[..]].map(|seeds| [seeds[0], seeds[seeds.len() - 1]]);
    writeln!(page, "{SEEDS}")?;
    writeln!(page, "| arms | `--arm-seed` | |\n|---|---|---|")?;
    writeln!(
        page,
        "| reference | {REFERENCE} | the arm of the tests and of the emulated board; constants were chosen on it |"
    )?;
    writeln!(page, "| development | {} to {} | constants were chosen on them |", development[0], development[1])?;
    writeln!(page, "| test | {} to {} | judge: no constant was chosen on them |", test[0], test[1])?;
    writeln!(page, "| other simulators | | judge: no constant was chosen on them |\n\n{REPRODUCE}")
}

/// Error of constant curvature on the real recording, if that is next to the checkout.
fn real(root: &Path) -> Result<Option<[f64; 2]>, Problem> {
    let recording = root.join("../shared/data/trunk-planar.csv");
    if !recording.exists() {
        eprintln!("no ../shared/data/trunk-planar.csv next to the checkout: its section stays empty");
        return Ok(None);
    }
    let path = root.join("host-tests/tables/trunk-planar.toml");
    let table = LoadedTable::load(&path)?;
    let mut score = ErrorMetrics::new(table.file.length_mm());
    replay::<estimator_core::Q>(&recording, &table, &mut NoProgress, |row, outcome| {
        score.add(row, outcome);
        Ok(())
    })?;
    let imu_o = score.metrics()[Method::ImuO as usize];
    Ok(imu_o.tip_rmse_mm.zip(imu_o.tip_rmse_percent).map(<[f64; 2]>::from))
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

const INTRODUCTION: &str = "\
# Results

`cargo xtask results` makes this page and [faults of sessions](faults-of-sessions.md): it simulates the sessions, calibrates each arm on
its own sweep, and replays the sessions in the board's fixed point, in some minutes. The same command gives the same pages, to the byte.
Nothing is tuned.

Everything here but the last section is simulated. What the page can show is how the methods compare with each other on the same
sessions, on arms that no constant was chosen on.
";

const SEEDS: &str = "\
## Seeds that chose and seeds that judge
";

const REPRODUCE: &str = "\
The seed of a session is 100 times its arm's, plus 0 for the sweep and 1, 2, 3 for scenarios I, II, III; plus 10 for slow motion, 20 fast,
30 one module, 40 rests, 50 leans, 60 a bent start and 70 a start in motion. To repeat a row, here arm 101 in scenario II:

```sh
proprio simulate --arm-seed 101 --scenario sweep --seed 10100 --seconds 900 --imu quaternion -o sweep.csv
proprio calibrate sweep.csv --arm calibration-tables/arms/planar-6.toml -o own.toml
proprio simulate --arm-seed 101 --scenario 2 --seed 10102 --seconds 900 --imu quaternion -o session.csv
proprio replay session.csv --table own.toml

# The paper's method: an arm description with the moving-average anchor.
(cat calibration-tables/arms/planar-6.toml; printf '[drift]\\nkind = \"anchor\"\\n') > anchor.toml
proprio calibrate sweep.csv --arm anchor.toml --map quadratic --hysteresis never -o paper.toml
proprio replay session.csv --table paper.toml
```
";

const PAPERS_TABLE: &str = "\
## The paper's Table I

RMSE of the tip in mm, reference arm | paper's arm. The first four rows are the paper's method, with its anchor. The flaws of the reference
arm (hysteresis, drift, pushes, an obstacle) were fitted to the figures that the paper gives: agreement with them is no evidence.
";

const REAL_ARM: &str = "\
629 samples of a tendon-driven soft arm of three segments, recorded optically
([trunk-stack](https://github.com/StanfordASL/trunk-stack), MIT licence). It has no bend sensors; its orientations are measured by the
cameras. It shows nothing of drift or fusion, only what constant curvature costs on real hardware: with ideal orientations the
kinematics misses the tip by";

const COMPARED: &str = "\
## Why the paper's figures cannot be compared with these

Its recordings and its arm are not public, so its sessions cannot be run through this estimator. Errors here are distances of the tip to
the truth in the world frame; the paper does not state its frame, and its text and its table differ in two places ([errata](paper.md)). A
simulated arm is as good as its makers' guesses. What can be checked against the paper is the order of the methods, and the one place
where ours differs: in scenario III its raw IMUs are better than its fusion.";
