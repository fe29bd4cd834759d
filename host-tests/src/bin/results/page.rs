//! The page that states what was measured.

use std::fmt::Write;

use calibration_tables::TuningKeys;
use estimator_core::Method;
use host_tests::contact::Found;
use proprio::honesty::HonestyFigures;

use crate::measure::{
    ANCHOR, Contact, DAY_SEED, HYSTERESIS, OBSERVER, Results, Run, SCENARIOS, SEEDS, TRAINING_S, TRAINING_SEED,
    VALIDATION_S,
};

/// The paper's Table I, RMSE mm: all, I, II, III of bend, imu_o, imu_c and fusion.
const PAPER: [[f64; 4]; 4] = [
    [24.62, 19.45, 30.10, 29.46],
    [30.27, 33.24, 36.68, 22.75],
    [17.68, 12.49, 21.88, 22.87],
    [16.96, 10.97, 20.24, 23.59],
];

impl Results {
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
        self.write_uncertainty(page)?;
        self.write_contact(page)?;
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
            for (figures, paper) in self.scenarios[ANCHOR].iter().zip(PAPER[m]) {
                write!(page, "| {} \\| {paper:.2} ", number(figures[m].tip_rmse_mm))?;
            }
            let all = self.scenarios[ANCHOR][0][m];
            writeln!(page, "| {} mm | {} % |", number(all.tip_p75_mm), number(all.tip_rmse_percent))?;
        }
        let ours = self.scenarios[OBSERVER].map(|figures| figures[3]);
        write!(page, "| **fusion, observer** ")?;
        for figures in ours {
            write!(page, "| **{}** ", number(figures.tip_rmse_mm))?;
        }
        writeln!(page, "| {} mm | {} % |", number(ours[0].tip_p75_mm), number(ours[0].tip_rmse_percent))?;
        writeln!(
            page,
            "\nThe first four rows are the paper's method, with its anchor; the last has the drift observer in its place, as \
             `calibrate` writes it. Mean RMSE of the V–Orient maps on the sweep: {:.2}° (paper: 4.72°, to which the twin was fitted).\n",
            self.maps_rmse_deg
        )
    }

    fn write_runs(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "## Run by run\n\nRMSE of the tip in mm.\n")?;
        writeln!(
            page,
            "| scenario | seed | bend | imu_o | imu_c | fusion, calibrated | fusion, tuned | observer | of fusion | and hysteresis |"
        )?;
        writeln!(page, "|---|---|---|---|---|---|---|---|---|---|")?;
        for Run { scenario, seed, fusion_before, after } in &self.runs {
            let [bend, imu_o, imu_c, fusion] = after[ANCHOR];
            let [observer, hysteresis] = [OBSERVER, HYSTERESIS].map(|table| after[table][3]);
            writeln!(
                page,
                "| {scenario} | {seed} | {bend:.2} | {imu_o:.2} | {imu_c:.2} | {fusion_before:.2} | {fusion:.2} | \
                 {observer:.2} | {:.0} % | {hysteresis:.2} |",
                observer / fusion * 100.0
            )?;
        }
        let best =
            self.runs.iter().filter(|run| run.after[ANCHOR][..3].iter().all(|other| *other >= run.after[ANCHOR][3]));
        let halved = self.runs.iter().filter(|run| run.after[OBSERVER][3] <= run.after[ANCHOR][3] / 2.0);
        writeln!(
            page,
            "\nThe observer's columns are fusion behind it, tuned on the same session; the last one has the bend sensors corrected for \
             hysteresis as well (`calibrate --hysteresis always`), which `calibrate` does by itself only where the sweep says \
             that it pays. With the anchor, fusion is the best of the four methods in {} of {} runs. With the observer, it has at most half of that \
             error in {}.\n",
            best.count(),
            self.runs.len(),
            halved.count()
        )
    }

    fn write_uncertainty(&self, page: &mut String) -> std::fmt::Result {
        writeln!(page, "{UNCERTAINTY}")?;
        writeln!(page, "| | scenario | tip: NEES | tip: inside | all ends: NEES | all ends: inside | angles: NEES |")?;
        writeln!(page, "|---|---|---|---|---|---|---|")?;
        for (name, table) in [("anchor", ANCHOR), ("observer", OBSERVER)] {
            for ((scenario, _), figures) in SCENARIOS.iter().zip(self.honesty[table]) {
                let Some(HonestyFigures { tip_nees, tip_inside_percent, end_nees, end_inside_percent, theta_nees }) =
                    figures
                else {
                    continue;
                };
                writeln!(
                    page,
                    "| {name} | {scenario} | {} | {} % | {} | {} % | {} |",
                    number(tip_nees),
                    number(tip_inside_percent),
                    number(end_nees),
                    number(end_inside_percent),
                    number(theta_nees)
                )?;
            }
        }
        writeln!(page)
    }

    fn write_contact(&self, page: &mut String) -> std::fmt::Result {
        let Contact { false_alarms, minutes, pushes, encounters } = self.contact;
        let of = |Found { found, all }: Found| format!("{found} of {all}");
        writeln!(page, "## Contact\n\nThe observer's table, seeds {SEEDS:?}.\n\n| scenario | what | |\n|---|---|---|")?;
        writeln!(page, "| I | contacts of the free arm in {minutes} min | {false_alarms} |")?;
        writeln!(
            page,
            "| II | pushes over 10°, found within 0.5 s of the first touch on their segment | {} |",
            of(pushes)
        )?;
        writeln!(
            page,
            "| III | times that the obstacle comes to bend a segment by over 10°, found within 0.5 s | {} |\n",
            of(encounters)
        )
    }

    fn write_tuning(&self, page: &mut String) -> std::fmt::Result {
        let TuningKeys { iterations, before, after, held_back_before, held_back_after, .. } = &self.tuning[OBSERVER];
        writeln!(
            page,
            "## Tuning\n\nOn scenario I, seed {TRAINING_SEED}, {TRAINING_S} s: {iterations} iterations behind the observer. RMSE of the tip {:.2} → {:.2} mm, of \
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

const UNCERTAINTY: &str = "\
## Uncertainty

Mean normalised square errors (NEES, for each coordinate: 1 is honest, more is too sure), and the share of true points inside
their 95 % ellipse, all seeds of a scenario together. The parameters are those of `calibrate` and `tune`.
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
