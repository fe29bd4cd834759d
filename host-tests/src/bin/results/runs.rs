//! Sessions of the simulated arm, the tables made of them, and their errors.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, DriftKeys, DriftKind, TuningKeys};
use estimator_core::Q;
use proprio::calibrate::{Calibration, CalibrationOptions, HysteresisMode, MapMode, calibrate};
use proprio::output::OutputFile;
use proprio::replay::{NamedTable, replay};
use proprio::score::Score;
use proprio::session::{ImuColumns, SessionWriter};
use proprio::simulate::Simulation;
use proprio::tune::{Tuner, Tuning};
use rig_twin::Scenario;

/// Samples a second: the paper's.
const RATE_HZ: f64 = 10.0;
const HOUR_US: u64 = 3_600_000_000;

/// Records a run of the twin.
pub fn session(folder: &Path, scenario: Scenario, seed: u64, seconds: f64) -> Result<PathBuf, Box<dyn Error>> {
    let path = folder.join(format!("{scenario:?}-{seed}-{seconds}.csv"));
    let mut writer = SessionWriter::new(OutputFile::create(&path, &[])?, ImuColumns::Deg)?;
    for sample in Simulation::new(scenario, seed, seconds, RATE_HZ)? {
        writer.write(&sample)?;
    }
    writer.into_inner().finish()?;
    Ok(path)
}

/// A table made of a sweep, and the mean RMSE of its V–Orient maps in degrees.
pub fn calibrated(
    arm: &ArmFile,
    sweep: &Path,
    drift: DriftKind,
    hysteresis: HysteresisMode,
    table: &Path,
) -> Result<f64, Box<dyn Error>> {
    let arm = ArmFile { drift: Some(DriftKeys { kind: drift, ..DriftKeys::kalman() }), ..arm.clone() };
    let arm = NamedTable { file: arm, path: table };
    let options = CalibrationOptions { maps: MapMode::Auto, hysteresis };
    let Calibration { table: file, sensors, .. } = calibrate(&[sweep.to_owned()], &arm, options)?;
    fs::write(table, file.to_toml())?;
    Ok(sensors.iter().map(|sensor| sensor.rmse_deg).sum::<f64>() / sensors.len() as f64)
}

/// A table whose filters were tuned on a session.
pub fn tuned(table: &Path, training: PathBuf, to: &Path) -> Result<TuningKeys, Box<dyn Error>> {
    let table = NamedTable::load(table)?;
    let Tuning { table, record, .. } = Tuner::new(&[training], &table)?.tune(|| false)?;
    fs::write(to, table.to_toml())?;
    Ok(record)
}

/// Errors of a session, all of it and hour by hour.
pub fn score(session: &Path, table: &Path) -> Result<(Score, Vec<Score>), Box<dyn Error>> {
    let table = NamedTable::load(table)?;
    let length_mm = table.file.length_mm();
    let (mut all, mut hours) = (Score::new(length_mm), Vec::new());
    replay::<Q>(session, &table, |row, outcome| {
        all.add(row, outcome);
        let hour = (row.sample.time_us / HOUR_US) as usize;
        hours.resize_with(hours.len().max(hour + 1), || Score::new(length_mm));
        hours[hour].add(row, outcome);
        Ok(())
    })?;
    Ok((all, hours))
}
