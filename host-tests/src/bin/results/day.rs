//! A day of free swings.

use std::fmt::{self, Write};

use estimator_core::{Method, Q};
use host_tests::parallel::in_parallel;
use host_tests::twin::{Replayer, row};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_simulation::Simulation;
use rig_twin::{Motion, Scenario};

use crate::arm::{Problem, RATE_HZ, Tables, setup};
use crate::family::{Family, REFERENCE, TEST};

const HOURS: usize = 24;
const HOUR_S: f64 = 3_600.0;

/// Figures of the first and the last hour of each arm.
pub struct Day {
    arms: Vec<(u64, [Hour; 2])>,
}

/// Tip RMSE of an hour, mm.
#[derive(Debug, Clone, Copy)]
struct Hour {
    fusion_mm: f64,
    inside_percent: f64,
    /// By the paper's method: bend, imu_o, imu_c, fusion.
    paper_mm: [f64; 4],
}

impl Day {
    /// Simulates a day of the reference arm and of a test arm.
    pub fn measure(family: &Family) -> Result<Self, Problem> {
        let arms = in_parallel(&[REFERENCE, TEST[0]], |seed| -> Result<_, Problem> {
            eprintln!("arm {seed}, a day");
            let hours = measure(family.tables(*seed)?, *seed)?;
            Ok((*seed, [hours[0], hours[HOURS - 1]]))
        });
        Ok(Self { arms: arms.into_iter().collect::<Result<_, _>>()? })
    }

    /// The table.
    pub fn write(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{DAY}")?;
        writeln!(
            page,
            "| arm | hour | fusion | bend | imu_o | paper's imu_c | paper's fusion |\n|---|---|---|---|---|---|---|"
        )?;
        for (seed, hours) in &self.arms {
            for (name, hour) in ["first", "last"].iter().zip(hours) {
                let [bend, imu_o, imu_c, fusion] = hour.paper_mm;
                let (own, inside) = (hour.fusion_mm, hour.inside_percent);
                writeln!(
                    page,
                    "| {seed} | {name} | **{own:.2}** ({inside:.0} %) | {bend:.2} | {imu_o:.2} | {imu_c:.2} | {fusion:.2} |"
                )?;
            }
        }
        writeln!(page)
    }
}

/// Figures hour by hour.
fn measure(tables: &Tables, seed: u64) -> Result<Vec<Hour>, Problem> {
    let compiled = [tables.own.compile::<Q>(RATE_HZ)?, tables.paper.compile::<Q>(RATE_HZ)?];
    let configs = compiled.each_ref().map(|compiled| compiled.config());
    let [mut own, mut paper] = configs.each_ref().map(Replayer::new);
    let length_mm = tables.own.length_mm();
    let mut hours = vec![[(); 2].map(|()| ErrorMetrics::new(length_mm)); HOURS];
    let simulation = Simulation::of(&setup(seed, Scenario::FreeSwing, Motion::Swings), HOUR_S * HOURS as f64, RATE_HZ)?;
    for (k, recorded) in simulation.enumerate() {
        let row = row(&recorded, k == 0);
        let [of_own, of_paper] = &mut hours[k / (HOUR_S * RATE_HZ) as usize];
        of_own.add(&row, &own.step(&row));
        of_paper.add(&row, &paper.step(&row));
    }
    Ok(hours.iter().map(Hour::of).collect())
}

impl Hour {
    fn of([own, paper]: &[ErrorMetrics; 2]) -> Self {
        let tip_mm = |score: &ErrorMetrics| score.metrics().map(|figures| figures.tip_rmse_mm.unwrap_or(f64::INFINITY));
        Self {
            fusion_mm: tip_mm(own)[Method::Fusion as usize],
            inside_percent: own.consistency().and_then(|figures| figures.tip_inside_percent).unwrap_or(f64::NAN),
            paper_mm: tip_mm(paper),
        }
    }
}

const DAY: &str = "\
## A day

24 h of scenario I. Tip RMSE in mm (share of true tips inside the 95 % ellipse) in the first and the last hour.
";
