//! What is measured, and the page that states it.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use calibration_tables::TuningKeys;
use estimator_core::Method;
use proprio::score::{Figures, Score};
use rig_twin::Scenario;

use crate::runs::{calibrated, observed, score, session, tuned};

/// Seeds of the sweep and of the training session.
const SWEEP_SEED: u64 = 1;
const TRAINING_SEED: u64 = 7;
/// Seeds of the validation: 15 min of each scenario.
const SEEDS: [u64; 3] = [41, 42, 43];
const SCENARIOS: [(&str, Scenario); 3] = [("I", Scenario::One), ("II", Scenario::Two), ("III", Scenario::Three)];
const VALIDATION_S: f64 = 900.0;
/// The paper's: 40 000 samples.
const TRAINING_S: f64 = 4_000.0;
const DAY_SEED: u64 = 51;
const DAY_S: f64 = 86_400.0;

/// The paper's Table I, RMSE mm: all, I, II, III of bend, imu_o, imu_c and fusion.
const PAPER: [[f64; 4]; 4] = [
    [24.62, 19.45, 30.10, 29.46],
    [30.27, 33.24, 36.68, 22.75],
    [17.68, 12.49, 21.88, 22.87],
    [16.96, 10.97, 20.24, 23.59],
];

/// All figures of the page, RMSE of the tip in mm by method.
pub struct Results {
    maps_rmse_deg: f64,
    tuning: TuningKeys,
    /// Of each scenario and seed, before tuning and after.
    runs: Vec<Run>,
    /// All, I, II, III, after tuning.
    scenarios: [[Figures; 4]; 4],
    /// First and last hour of a day, and the fusion of each with the observer.
    day: [([f64; 4], f64); 2],
    /// Of the real recording, imu_o, where it is there; mm and %.
    real: Option<[f64; 2]>,
}

struct Run {
    scenario: &'static str,
    seed: u64,
    fusion_before: f64,
    after: [f64; 4],
    /// Fusion with the observer in the anchor's place.
    observer: f64,
}

fn rmse(score: &Score) -> [f64; 4] {
    score.figures().map(|figures| figures.tip_rmse_mm.unwrap_or(f64::NAN))
}

impl Results {
    /// Runs everything, in `folder`.
    pub fn measure(root: &Path, folder: &Path) -> Result<Self, Box<dyn Error>> {
        let [calibrated_toml, tuned_toml, untuned_toml, observed_toml] =
            ["calibrated.toml", "tuned.toml", "untuned.toml", "observed.toml"].map(|name| folder.join(name));
        let sweep = session(folder, Scenario::Sweep, SWEEP_SEED, VALIDATION_S)?;
        let arm = root.join("calibration-tables/arms/planar-6.toml");
        let maps_rmse_deg = calibrated(&arm, &sweep, &calibrated_toml)?;
        eprintln!("calibrated; training");
        let training = session(folder, Scenario::One, TRAINING_SEED, TRAINING_S)?;
        let tuning = tuned(&calibrated_toml, training.clone(), &tuned_toml)?;
        observed(&calibrated_toml, &untuned_toml)?;
        tuned(&untuned_toml, training, &observed_toml)?;

        let length_mm = proprio::replay::NamedTable::load(&tuned_toml)?.file.length_mm();
        let mut sums = [(); 4].map(|()| Score::new(length_mm));
        let mut runs = Vec::new();
        for (k, (name, scenario)) in SCENARIOS.into_iter().enumerate() {
            for seed in SEEDS {
                eprintln!("scenario {name}, seed {seed}");
                let path = session(folder, scenario, seed, VALIDATION_S)?;
                let [before, after] = [score(&path, &calibrated_toml)?.0, score(&path, &tuned_toml)?.0];
                let [.., observer] = rmse(&score(&path, &observed_toml)?.0);
                sums[0].append(&after);
                sums[k + 1].append(&after);
                let [.., fusion_before] = rmse(&before);
                runs.push(Run { scenario: name, seed, fusion_before, after: rmse(&after), observer });
            }
        }
        eprintln!("a day of scenario I");
        let day = session(folder, Scenario::One, DAY_SEED, DAY_S)?;
        let [(_, anchor), (_, observer)] = [score(&day, &tuned_toml)?, score(&day, &observed_toml)?];
        let of = |hours: &[Score], hour: usize| hours.get(hour).map_or([f64::NAN; 4], rmse);
        let day = [0, anchor.len() - 1].map(|hour| (of(&anchor, hour), of(&observer, hour)[3]));
        Ok(Self { maps_rmse_deg, tuning, runs, scenarios: sums.each_ref().map(Score::figures), day, real: real(root)? })
    }

    /// The page.
    pub fn to_markdown(&self) -> String {
        let mut page = String::new();
        // Writing to a string does not fail.
        let _ = self.write(&mut page);
        page
    }

    fn write(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "{INTRODUCTION}")?;
        self.write_table(page)?;
        self.write_runs(page)?;
        self.write_tuning(page)?;
        self.write_day(page)?;
        self.write_real(page)?;
        writeln!(page, "{COMPARED}")
    }

    fn write_table(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "## The paper's Table I\n")?;
        writeln!(
            page,
            "RMSE of the tip in mm, simulated arm | paper's arm. Seeds {SEEDS:?} of each scenario, {VALIDATION_S} s each, none of \
             them used for calibration or tuning.\n"
        )?;
        writeln!(page, "| method | all | I | II | III | 75th percentile, all | % of length, all |")?;
        writeln!(page, "|---|---|---|---|---|---|---|")?;
        for m in [3, 0, 2, 1] {
            write!(page, "| {} ", Method::ALL[m].name())?;
            for (figures, paper) in self.scenarios.iter().zip(PAPER[m]) {
                write!(page, "| {} \\| {paper:.2} ", number(figures[m].tip_rmse_mm))?;
            }
            let all = self.scenarios[0][m];
            writeln!(page, "| {} mm | {} % |", number(all.tip_p75_mm), number(all.tip_rmse_percent))?;
        }
        writeln!(
            page,
            "\nMean RMSE of the V–Orient maps on the sweep: {:.2}° (paper: 4.72°, to which the twin was fitted).\n",
            self.maps_rmse_deg
        )
    }

    fn write_runs(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "## Run by run\n\nRMSE of the tip in mm.\n")?;
        writeln!(
            page,
            "| scenario | seed | bend | imu_o | imu_c | fusion, calibrated | fusion, tuned | observer, tuned |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|")?;
        for Run { scenario, seed, fusion_before, after: [bend, imu_o, imu_c, fusion], observer } in &self.runs {
            writeln!(
                page,
                "| {scenario} | {seed} | {bend:.2} | {imu_o:.2} | {imu_c:.2} | {fusion_before:.2} | {fusion:.2} | {observer:.2} |"
            )?;
        }
        let worse = |run: &&Run| run.after[..3].iter().any(|other| *other < run.after[3]);
        let lost: Vec<&Run> = self.runs.iter().filter(worse).collect();
        writeln!(
            page,
            "\nThe last column has the drift observer in the anchor's place. After tuning, fusion with the anchor is the best of the four in {} of {} runs.",
            self.runs.len() - lost.len(),
            self.runs.len()
        )?;
        for Run { scenario, seed, after, .. } in lost {
            let best = after.iter().copied().fold(f64::INFINITY, f64::min);
            writeln!(
                page,
                "In scenario {scenario}, seed {seed}, it is {:.2} mm worse than the best.",
                after[3] - best
            )?;
        }
        writeln!(page)
    }

    fn write_tuning(&self, page: &mut String) -> std::fmt::Result {
        let TuningKeys { iterations, before, after, held_back_before, held_back_after, .. } = &self.tuning;
        writeln!(
            page,
            "## Tuning\n\nOn scenario I, seed {TRAINING_SEED}, {TRAINING_S} s: {iterations} iterations. RMSE of the tip {:.2} → {:.2} mm, of \
             headings {:.2} → {:.2}°; on the last fifth, which was held back, {:.2} → {:.2} mm and {:.2} → {:.2}°.\n",
            before.tip_rmse_mm,
            after.tip_rmse_mm,
            before.heading_rmse_deg,
            after.heading_rmse_deg,
            held_back_before.tip_rmse_mm,
            held_back_after.tip_rmse_mm,
            held_back_before.heading_rmse_deg,
            held_back_after.heading_rmse_deg
        )
    }

    fn write_day(&self, page: &mut String) -> std::fmt::Result {
        writeln!(
            page,
            "## A day\n\n24 h of scenario I, seed {DAY_SEED}, at the paper's drift. RMSE of the tip in mm.\n"
        )?;
        writeln!(page, "| | bend | imu_o | imu_c | fusion | fusion, observer |\n|---|---|---|---|---|---|")?;
        for (name, ([bend, imu_o, imu_c, fusion], observer)) in ["first hour", "last hour"].iter().zip(self.day) {
            writeln!(page, "| {name} | {bend:.2} | {imu_o:.2} | {imu_c:.2} | {fusion:.2} | {observer:.2} |")?;
        }
        writeln!(page)
    }

    fn write_real(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "## A real arm\n")?;
        match self.real {
            Some([mm, percent]) => writeln!(page, "{REAL_ARM} {mm:.2} mm RMSE, {percent:.2} % of its length.\n"),
            None => writeln!(page, "The recording was not there when this page was made.\n"),
        }
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

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

const INTRODUCTION: &str = "\
# Results

`cargo xtask results` makes this page: it simulates the sessions, calibrates, tunes and replays them in the board's fixed
point, in some minutes. The same command gives the same page.

Everything here but the last section is simulated. The twin's flaws (hysteresis, drift, pushes, an obstacle) were fitted to the
figures that the paper gives, so that agreement with them is no evidence; what the page can show is how the methods
compare with each other on the same sessions, and that they hold for a day.
";

const REAL_ARM: &str = "\
629 samples of a tendon-driven soft arm of three segments, recorded optically ([trunk-stack](https://github.com/StanfordASL/trunk-stack), \
MIT licence). It has no bend sensors; its orientations are measured by the cameras, so that it says nothing of \
drift or fusion, but what constant curvature alone costs on real hardware: with ideal orientations the kinematics misses the tip by";

const COMPARED: &str = "\
## Why the paper's figures cannot be compared with these

Its recordings and its arm are not public, so nobody can run its sessions through this estimator. Errors here are distances
of the tip to the truth in the world frame; the paper does not say its frame, and its text and its table differ in two
places ([PAPER.md](PAPER.md)). A simulated arm is as good as its makers' guesses. What can be checked against the paper is
the order of the methods, and the one place where ours differs: in scenario III its raw IMUs are better than its fusion.";
