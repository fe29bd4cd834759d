//! What is measured.

use std::error::Error;
use std::path::Path;

use calibration_tables::{ArmFile, DriftKind, TuningKeys};
use host_tests::contact::{Found, Run as ContactRun};
use proprio::calibrate::HysteresisMode;
use proprio::honesty::HonestyFigures;
use proprio::score::{Figures, Score};
use rig_twin::Scenario;

use crate::runs::{calibrated, score, session, tuned};

/// Seeds of the sweep and of the training session.
const SWEEP_SEED: u64 = 1;
pub const TRAINING_SEED: u64 = 7;
/// Seeds of the validation: 15 min of each scenario.
pub const SEEDS: [u64; 3] = [41, 42, 43];
pub const SCENARIOS: [(&str, Scenario); 3] = [("I", Scenario::One), ("II", Scenario::Two), ("III", Scenario::Three)];
pub const VALIDATION_S: f64 = 900.0;
/// The paper's: 40 000 samples.
pub const TRAINING_S: f64 = 4_000.0;
pub const DAY_SEED: u64 = 51;
const DAY_S: f64 = 86_400.0;

/// The tables that are compared, all of one sweep and tuned on one session.
pub const ANCHOR: usize = 0;
pub const OBSERVER: usize = 1;
pub const HYSTERESIS: usize = 2;
const TABLES: [(&str, DriftKind, HysteresisMode); 3] = [
    ("anchor", DriftKind::Anchor, HysteresisMode::Auto),
    ("observer", DriftKind::Observer, HysteresisMode::Auto),
    ("hysteresis", DriftKind::Observer, HysteresisMode::Always),
];

/// All figures of the page. Of several methods, RMSE of the tip in mm.
pub struct Results {
    pub maps_rmse_deg: f64,
    /// How each table was tuned.
    pub tuning: [TuningKeys; 3],
    /// Of each scenario and seed.
    pub runs: Vec<Run>,
    /// By table, and of each all, I, II, III.
    pub scenarios: [[Figures4; 4]; 3],
    /// By table, and of each I, II, III.
    pub honesty: [[Option<HonestyFigures>; 3]; 3],
    /// Of scenarios I, II and III.
    pub contact: Contact,
    /// First and last hour of a day, by the anchor's table and fusion by the observer's.
    pub day: [([f64; 4], f64); 2],
    /// Of the real recording, imu_o, where it is there; mm and %.
    pub real: Option<[f64; 2]>,
}

/// By method.
pub type Figures4 = [Figures; 4];

/// One validation run.
pub struct Run {
    pub scenario: &'static str,
    pub seed: u64,
    /// By the anchor's table as it was calibrated.
    pub fusion_before: f64,
    /// By table and method.
    pub after: [[f64; 4]; 3],
}

/// What contact was told of, on all seeds together.
pub struct Contact {
    /// In [`Contact::minutes`] of scenario I.
    pub false_alarms: usize,
    pub minutes: f64,
    /// In scenario II.
    pub pushes: Found,
    /// In scenario III.
    pub encounters: Found,
}

fn rmse(score: &Score) -> [f64; 4] {
    score.figures().map(|figures| figures.tip_rmse_mm.unwrap_or(f64::NAN))
}

impl Results {
    /// Runs everything, in `folder`.
    pub fn measure(root: &Path, folder: &Path) -> Result<Self, Box<dyn Error>> {
        let sweep = session(folder, Scenario::Sweep, SWEEP_SEED, VALIDATION_S)?;
        let arm = ArmFile::load(&root.join("calibration-tables/arms/planar-6.toml"))?;
        let training = session(folder, Scenario::One, TRAINING_SEED, TRAINING_S)?;
        let (mut maps_rmse_deg, mut tuning) = (f64::NAN, Vec::new());
        let [calibrated_tables, tuned_tables] =
            ["calibrated", "tuned"].map(|step| TABLES.map(|(name, _, _)| folder.join(format!("{name}-{step}.toml"))));
        for ((name, drift, hysteresis), (from, to)) in
            TABLES.into_iter().zip(calibrated_tables.iter().zip(&tuned_tables))
        {
            eprintln!("calibrating and training: {name}");
            maps_rmse_deg = calibrated(&arm, &sweep, drift, hysteresis, from)?;
            tuning.push(tuned(from, training.clone(), to)?);
        }
        let length_mm = arm.length_mm();
        let mut sums = [(); 3].map(|()| [(); 4].map(|()| Score::new(length_mm)));
        let mut runs = Vec::new();
        for (k, (scenario, program)) in SCENARIOS.into_iter().enumerate() {
            for seed in SEEDS {
                eprintln!("scenario {scenario}, seed {seed}");
                let path = session(folder, program, seed, VALIDATION_S)?;
                let [.., fusion_before] = rmse(&score(&path, &calibrated_tables[ANCHOR])?.0);
                let mut after = [[f64::NAN; 4]; 3];
                for (table, (sums, after)) in tuned_tables.iter().zip(sums.iter_mut().zip(&mut after)) {
                    let score = score(&path, table)?.0;
                    sums[0].append(&score);
                    sums[k + 1].append(&score);
                    *after = rmse(&score);
                }
                runs.push(Run { scenario, seed, fusion_before, after });
            }
        }
        eprintln!("contact");
        let contact = Contact::measure(&ArmFile::load(&tuned_tables[OBSERVER])?)?;
        eprintln!("a day of scenario I");
        let day = session(folder, Scenario::One, DAY_SEED, DAY_S)?;
        let [(_, anchor), (_, observer)] = [score(&day, &tuned_tables[ANCHOR])?, score(&day, &tuned_tables[OBSERVER])?];
        let of = |hours: &[Score], hour: usize| hours.get(hour).map_or([f64::NAN; 4], rmse);
        let day = [0, anchor.len() - 1].map(|hour| (of(&anchor, hour), of(&observer, hour)[3]));
        Ok(Self {
            maps_rmse_deg,
            tuning: tuning.try_into().map_err(|_| "one record a table")?,
            runs,
            honesty: sums.each_ref().map(|[_, scenarios @ ..]| scenarios.each_ref().map(Score::honesty)),
            scenarios: sums.each_ref().map(|sums| sums.each_ref().map(Score::figures)),
            contact,
            day,
            real: real(root)?,
        })
    }
}

impl Contact {
    fn measure(table: &ArmFile) -> Result<Self, Box<dyn Error>> {
        let mut contact = Self {
            false_alarms: 0,
            minutes: SEEDS.len() as f64 * VALIDATION_S / 60.0,
            pushes: Found::default(),
            encounters: Found::default(),
        };
        for seed in SEEDS {
            let run = |scenario| ContactRun::new(table, scenario, seed, VALIDATION_S);
            contact.false_alarms += run(Scenario::One)?.alarms();
            contact.pushes += run(Scenario::Two)?.pushes();
            contact.encounters += run(Scenario::Three)?.encounters();
        }
        Ok(contact)
    }
}

/// The floor of constant curvature on the real recording, where it is beside the repository.
fn real(root: &Path) -> Result<Option<[f64; 2]>, Box<dyn Error>> {
    let recording = root.join("../shared/data/trunk-planar.csv");
    if !recording.exists() {
        return Ok(None);
    }
    let [_, imu_o, ..] = score(&recording, &root.join("host-tests/tables/trunk-planar.toml"))?.0.figures();
    Ok(imu_o.tip_rmse_mm.zip(imu_o.tip_rmse_percent).map(<[f64; 2]>::from))
}
