//! Motions that the paper does not have, on some of the test arms.

use std::fmt::{self, Write};

use host_tests::contact::alarms;
use host_tests::parallel::in_parallel;
use host_tests::twin::TwinSession;
use rig_twin::{Motion, Scenario};

use crate::arm::{Problem, RATE_HZ, SESSION_S, Tables, setup};
use crate::evaluation::{Evaluation, Figures, mean_and_worst};
use crate::family::Family;

/// The first of the test arms.
pub const ARMS: [u64; 4] = [101, 102, 103, 104];

/// Name, motion, scenario, seconds.
const MOTIONS: [(&str, Motion, Scenario, f64); 9] = [
    ("rests of 2 min to 2 h, 4 h in all", Motion::Rests, Scenario::FreeSwing, 14_400.0),
    ("one module alone", Motion::OneModule, Scenario::FreeSwing, SESSION_S),
    ("slow", Motion::Slow, Scenario::FreeSwing, 2.0 * SESSION_S),
    ("fast", Motion::Fast, Scenario::FreeSwing, SESSION_S),
    ("leans of minutes", Motion::Lean, Scenario::FreeSwing, 2.0 * SESSION_S),
    ("leans on the obstacle", Motion::Lean, Scenario::Obstacle, 2.0 * SESSION_S),
    ("starts in contact", Motion::BentStart, Scenario::Obstacle, SESSION_S),
    ("starts bent", Motion::BentStart, Scenario::FreeSwing, SESSION_S),
    ("starts in motion", Motion::MovingStart, Scenario::FreeSwing, SESSION_S),
];

/// Figures of each motion by arm.
pub struct Motions {
    rows: Vec<[Figures; ARMS.len()]>,
    /// Contacts of each motion, over all arms.
    contacts: Vec<usize>,
}

impl Motions {
    /// Simulates and replays all of them with the tables of `family`.
    pub fn measure(family: &Family) -> Result<Self, Problem> {
        let jobs: Vec<(usize, u64)> = (0..MOTIONS.len()).flat_map(|k| ARMS.map(|seed| (k, seed))).collect();
        let figures = in_parallel(&jobs, |(k, seed)| {
            let (name, motion, scenario, seconds) = MOTIONS[*k];
            eprintln!("arm {seed}, {name}");
            measure(family.tables(*seed)?, *seed, (motion, scenario), seconds)
        });
        let figures = figures.into_iter().collect::<Result<Vec<_>, _>>()?;
        let rows = figures.chunks_exact(ARMS.len());
        Ok(Self {
            contacts: rows.clone().map(|row| row.iter().map(|(_, contacts)| contacts).sum()).collect(),
            rows: rows.map(|row| std::array::from_fn(|arm| row[arm].0)).collect(),
        })
    }

    /// Free motions: name, false alarms over all arms, seconds.
    pub fn false_alarms(&self) -> impl Iterator<Item = (&'static str, usize, f64)> {
        let motions = MOTIONS.iter().zip(&self.contacts);
        let free = motions.filter(|((_, _, scenario, _), _)| *scenario == Scenario::FreeSwing);
        free.map(|((name, _, _, seconds), contacts)| (*name, *contacts, ARMS.len() as f64 * seconds))
    }

    /// The table.
    pub fn write(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{MOTIONS_TEXT}")?;
        write!(page, "| motion |")?;
        ARMS.iter().try_for_each(|seed| write!(page, " {seed} |"))?;
        writeln!(page, " mean | paper's method | best raw |\n|---|---|---|---|---|---|---|---|")?;
        for ((name, ..), row) in MOTIONS.iter().zip(&self.rows) {
            write!(page, "| {name} |")?;
            row.iter().try_for_each(|figures| write!(page, " {} |", figures.fusion_and_inside()))?;
            let mean = |of: fn(&Figures) -> f64| mean_and_worst(row.iter().map(of)).0;
            let [fusion, paper, raw] =
                [mean(|figures| figures.fusion_mm), mean(|figures| figures.paper_mm), mean(|figures| figures.raw_mm)];
            writeln!(page, " **{fusion:.1}** | {paper:.1} | {raw:.1} |")?;
        }
        writeln!(page)
    }
}

fn measure(
    tables: &Tables,
    seed: u64,
    (motion, scenario): (Motion, Scenario),
    seconds: f64,
) -> Result<(Figures, usize), Problem> {
    let session = TwinSession::new(&setup(seed, scenario, motion), seconds, RATE_HZ)?;
    let evaluation = Evaluation::of_twin(tables, &session)?;
    Ok((evaluation.figures(), alarms(&evaluation.contact)))
}

const MOTIONS_TEXT: &str = "\
## Motions

Tip RMSE of fusion in mm (share of true tips inside the 95 % ellipse) on four of the test arms. A session that starts bent, in contact or
in motion has its tare while it is.
";
