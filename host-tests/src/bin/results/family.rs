//! Arms of the twin's family, in the paper's three scenarios.

use std::fmt::{self, Write};
use std::path::Path;

use calibration_tables::ArmFile;
use host_tests::contact::{ContactSession, Found};
use host_tests::parallel::in_parallel;
use host_tests::twin::TwinSession;
use proprio_analysis::metrics::Metrics as MethodMetrics;
use rig_twin::{Motion, Scenario};

use crate::arm::{Problem, RATE_HZ, SESSION_S, Tables, setup};
use crate::evaluation::{Evaluation, Figures, fusion_mm, mean_and_worst};

pub const REFERENCE: u64 = 0;
pub const DEVELOPMENT: [u64; 6] = [1, 2, 3, 4, 5, 6];
pub const TEST: [u64; 12] = [101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111, 112];
pub const SCENARIOS: [(&str, Scenario); 3] =
    [("I", Scenario::FreeSwing), ("II", Scenario::Push), ("III", Scenario::Obstacle)];

/// An arm, and its figures in each scenario.
pub struct ArmFigures {
    pub seed: u64,
    pub tables: Tables,
    pub scenarios: [Figures; 3],
    /// All methods by the paper's table.
    pub paper: [[MethodMetrics; 4]; 3],
    /// Fusion with quadratic maps and no memory, mm.
    pub quadratic_mm: [f64; 3],
    pub contact: Contact,
}

/// Contacts that were found.
#[derive(Debug, Clone, Copy, Default)]
pub struct Contact {
    /// In scenario I.
    pub false_alarms: usize,
    /// In scenario II.
    pub pushes: Found,
    /// In scenario III.
    pub encounters: Found,
}

/// All arms.
pub struct Family {
    pub arms: Vec<ArmFigures>,
}

impl ArmFigures {
    fn measure(seed: u64, arm: &ArmFile, folder: &Path) -> Result<Self, Problem> {
        let tables = Tables::of_twin(seed, arm, folder)?;
        let (mut scenarios, mut paper, mut quadratic_mm) = (Vec::new(), Vec::new(), Vec::new());
        let mut runs = Vec::new();
        for (_, scenario) in SCENARIOS {
            let session = TwinSession::new(&setup(seed, scenario, Motion::Swings), SESSION_S, RATE_HZ)?;
            let evaluation = Evaluation::of_twin(&tables, &session)?;
            scenarios.push(evaluation.figures());
            paper.push(evaluation.paper.metrics());
            quadratic_mm.push(fusion_mm(&tables.quadratic, &session)?);
            runs.push(ContactSession::of(session, evaluation.contact));
        }
        let contact =
            Contact { false_alarms: runs[0].alarms(), pushes: runs[1].pushes(), encounters: runs[2].encounters() };
        let three = "one entry a scenario";
        Ok(Self {
            seed,
            tables,
            scenarios: scenarios.try_into().map_err(|_| three)?,
            paper: paper.try_into().map_err(|_| three)?,
            quadratic_mm: quadratic_mm.try_into().map_err(|_| three)?,
            contact,
        })
    }
}

impl Family {
    /// Simulates, calibrates and replays all arms.
    pub fn measure(arm: &ArmFile, folder: &Path) -> Result<Self, Problem> {
        let seeds: Vec<u64> = [REFERENCE].into_iter().chain(DEVELOPMENT).chain(TEST).collect();
        let arms = in_parallel(&seeds, |seed| {
            eprintln!("arm {seed}");
            ArmFigures::measure(*seed, arm, folder)
        });
        Ok(Self { arms: arms.into_iter().collect::<Result<_, _>>()? })
    }

    /// An arm that was measured.
    pub fn arm(&self, seed: u64) -> Option<&ArmFigures> {
        self.arms.iter().find(|arm| arm.seed == seed)
    }

    /// The tables of an arm that was measured.
    pub fn tables(&self, seed: u64) -> Result<&Tables, Problem> {
        Ok(&self.arm(seed).ok_or_else(|| format!("arm {seed} was not measured"))?.tables)
    }

    pub fn of<'f>(&'f self, seeds: &[u64]) -> Vec<&'f ArmFigures> {
        seeds.iter().filter_map(|seed| self.arm(*seed)).collect()
    }

    /// The tables of the arms' errors.
    pub fn write(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{SUMMARY}")?;
        writeln!(
            page,
            "| arms | scenario | fusion | worst | inside | lowest | NEES | flagged | smoothed | worst | inside | lowest | paper's method | best raw |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")?;
        let groups: [(&str, &[u64]); 3] =
            [("**test**", &TEST), ("development", &DEVELOPMENT), ("reference", &[REFERENCE])];
        for (name, seeds) in groups {
            let arms = self.of(seeds);
            for (k, (scenario, _)) in SCENARIOS.iter().enumerate() {
                let figures: Vec<Figures> = arms.iter().map(|arm| arm.scenarios[k]).collect();
                write_summary(page, &format!("{name} | {scenario}"), &figures)?;
            }
            let all: Vec<Figures> = arms.iter().flat_map(|arm| arm.scenarios).collect();
            write_summary(page, &format!("{name} | all"), &all)?;
        }
        self.write_arms(page)?;
        self.write_maps(page)
    }

    fn write_arms(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{ARM_BY_ARM}")?;
        writeln!(
            page,
            "| arm | I | smoothed | paper | raw | II | smoothed | paper | raw | III | smoothed | paper | raw |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|---|---|---|")?;
        for arm in &self.arms {
            write!(page, "| {} ", arm.seed)?;
            for figures in arm.scenarios {
                let Figures { paper_mm, raw_mm, .. } = figures;
                let [fusion, smoothed] = [figures.fusion_and_inside(), figures.smoothed_and_inside()];
                write!(page, "| {fusion} | {smoothed} | {paper_mm:.1} | {raw_mm:.1} ")?;
            }
            writeln!(page, "|")?;
        }
        writeln!(page)
    }

    fn write_maps(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{MAPS}")?;
        writeln!(page, "| maps | I | II | III | all |\n|---|---|---|---|---|")?;
        let arms = self.of(&TEST);
        let row = |page: &mut String, name: &str, of: &dyn Fn(&ArmFigures, usize) -> f64| {
            write!(page, "| {name} ")?;
            for k in 0..SCENARIOS.len() {
                write!(page, "| {:.2} ", mean_and_worst(arms.iter().map(|arm| of(arm, k))).0)?;
            }
            let all = arms.iter().flat_map(|arm| (0..SCENARIOS.len()).map(|k| of(arm, k)));
            writeln!(page, "| {:.2} |", mean_and_worst(all).0)
        };
        row(page, "as `calibrate` chooses them", &|arm, k| arm.scenarios[k].fusion_mm)?;
        row(page, "quadratic, no memory", &|arm, k| arm.quadratic_mm[k])?;
        writeln!(page)
    }
}

impl Figures {
    /// Fusion's RMSE, and the share inside the ellipse.
    pub fn fusion_and_inside(&self) -> String {
        format!("{:.1} ({:.0} %)", self.fusion_mm, self.inside_percent)
    }

    /// RMSE of the smoothed estimates, and the share inside the ellipse.
    pub fn smoothed_and_inside(&self) -> String {
        format!("{:.1} ({:.0} %)", self.smoothed_mm, self.smoothed_inside_percent)
    }
}

/// A row of means, worst and lowest.
pub fn write_summary(page: &mut String, name: &str, all: &[Figures]) -> fmt::Result {
    let mean = |of: fn(&Figures) -> f64| mean_and_worst(all.iter().map(of)).0;
    let (fusion, worst) = mean_and_worst(all.iter().map(|figures| figures.fusion_mm));
    let (smoothed, smoothed_worst) = mean_and_worst(all.iter().map(|figures| figures.smoothed_mm));
    let lowest = |of: fn(&Figures) -> f64| all.iter().map(of).fold(f64::INFINITY, f64::min);
    write!(
        page,
        "| {name} | **{fusion:.2}** | {worst:.1} | {:.1} % | {:.1} % | {:.2} | {:.1} % ",
        mean(|figures| figures.inside_percent),
        lowest(|figures| figures.inside_percent),
        mean(|figures| figures.nees),
        mean(|figures| figures.flagged_percent)
    )?;
    writeln!(
        page,
        "| {smoothed:.2} | {smoothed_worst:.1} | {:.1} % | {:.1} % | {:.2} | {:.2} |",
        mean(|figures| figures.smoothed_inside_percent),
        lowest(|figures| figures.smoothed_inside_percent),
        mean(|figures| figures.paper_mm),
        mean(|figures| figures.raw_mm)
    )
}

const SUMMARY: &str = "\
## Arms of the twin's family

Tip RMSE in mm. Mean and worst session of fusion, mean and lowest share of true tips inside the 95 % ellipse, mean NEES of the tip
(for each coordinate: 1 is consistent, above 1 overconfident), mean share of time in which the estimator reports a condition although
nothing is wrong; the same of the estimates that [the smoother](smoothing.md) makes of the whole recording; the paper's method (quadratic maps, moving-average anchor, KF_orient and KF_coord) on the same sweep, and the better
of bend sensors and raw IMUs in each session. 15 min a session.
";

const ARM_BY_ARM: &str = "
### Arm by arm

Tip RMSE of fusion and of the smoothed estimates in mm (share of true tips inside the 95 % ellipse), of the paper's method, and of the better of bend sensors and raw
IMUs.
";

const MAPS: &str = "\
### Maps

Mean tip RMSE of fusion over the test arms, mm.
";
