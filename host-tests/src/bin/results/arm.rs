//! Arms, and their tables as calibrated on their own sweeps.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, DriftKind, DriftToml};
use proprio_calibration::calibrate::{Calibration, CalibrationOptions, HysteresisMode, MapMode, calibrate};
use proprio_session::{Existing, LoadedTable, NoProgress, OutputFile};
use proprio_simulation::{ImuColumns, SessionWriter, Simulation};
use rig_twin::{Motion, Scenario, Setup};

/// Reason why a figure cannot be measured.
pub type Problem = Box<dyn Error + Send + Sync>;

/// Samples a second: the paper's.
pub const RATE_HZ: f64 = 10.0;
/// Length of a sweep and of a session.
pub const SESSION_S: f64 = 900.0;

/// Tables of one arm, all of one sweep, nothing tuned.
pub struct Tables {
    /// As `calibrate` makes it.
    pub own: ArmFile,
    /// The same with the paper's quadratic maps and without hysteresis compensation.
    pub quadratic: ArmFile,
    /// The paper's method: quadratic maps, the anchor, KF_orient and KF_coord.
    pub paper: ArmFile,
    /// Mean RMSE of the quadratic maps on the sweep, degrees.
    pub maps_rmse_deg: f64,
}

impl Tables {
    /// Calibrates the arm of a sweep.
    pub fn of_sweep(sweep: &Path, arm: &ArmFile) -> Result<Self, Problem> {
        let quadratic = CalibrationOptions { maps: MapMode::Quadratic, hysteresis: HysteresisMode::Never };
        let anchored =
            ArmFile { drift: Some(DriftToml { kind: DriftKind::Anchor, ..DriftToml::kalman() }), ..arm.clone() };
        let table = |file: &ArmFile, options| -> Result<Calibration, Problem> {
            Ok(calibrate(
                &[sweep.to_owned()],
                &LoadedTable { file: file.clone(), path: Path::new("planar-6.toml") },
                options,
                &mut NoProgress,
            )?)
        };
        let Calibration { table: paper, sensors, .. } = table(&anchored, quadratic)?;
        Ok(Self {
            own: table(arm, CalibrationOptions::default())?.table,
            quadratic: table(arm, quadratic)?.table,
            paper,
            maps_rmse_deg: sensors.iter().map(|sensor| sensor.rmse_deg).sum::<f64>() / sensors.len() as f64,
        })
    }

    /// Calibrates an arm of the twin on its own sweep, which is written in `folder`.
    pub fn of_twin(arm_seed: u64, arm: &ArmFile, folder: &Path) -> Result<Self, Problem> {
        Self::of_sweep(&sweep(arm_seed, folder)?, arm)
    }
}

/// Writes the sweep of an arm of the twin.
pub fn sweep(arm_seed: u64, folder: &Path) -> Result<PathBuf, Problem> {
    let path = folder.join(format!("sweep-{arm_seed}.csv"));
    let setup = setup(arm_seed, Scenario::Sweep, Motion::Swings);
    let file = OutputFile::create(&path, &[], Existing::Replace)?;
    let mut writer = SessionWriter::new(file, &setup.layout, ImuColumns::Quaternion)?;
    for sample in Simulation::of(&setup, SESSION_S, RATE_HZ)? {
        writer.write(&sample)?;
    }
    writer.into_inner().finish()?;
    Ok(path)
}

/// Set-up of a session of an arm with this motion.
pub fn setup(arm_seed: u64, scenario: Scenario, motion: Motion) -> Setup {
    Setup { arm_seed, motion, ..Setup::new(scenario, session_seed(arm_seed, scenario, motion)) }
}

/// Seed of a session: no two of an arm share one.
pub fn session_seed(arm_seed: u64, scenario: Scenario, motion: Motion) -> u64 {
    let scenario = match scenario {
        Scenario::Sweep => 0,
        Scenario::FreeSwing => 1,
        Scenario::Push => 2,
        Scenario::Obstacle => 3,
    };
    let motion = match motion {
        Motion::Swings => 0,
        Motion::Slow => 10,
        Motion::Fast => 20,
        Motion::OneModule => 30,
        Motion::Rests => 40,
        Motion::Lean => 50,
        Motion::BentStart => 60,
        Motion::MovingStart => 70,
    };
    100 * arm_seed + motion + scenario
}

/// Description of the arm that all tables are made for.
pub fn planar(root: &Path) -> Result<ArmFile, Problem> {
    Ok(ArmFile::load(&root.join("calibration-tables/arms/planar-6.toml"))?)
}

/// Reads a text file; an error names the file.
pub fn read(path: &Path) -> Result<String, Problem> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()).into())
}
