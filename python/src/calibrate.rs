//! Calibration.

use std::path::{Path, PathBuf};

use estimator_core::Method;
use proprio::Help;
use proprio_calibration::calibrate::{
    Calibration, CalibrationOptions, HeldOut, HysteresisMode, MapKind, MapMode, calibrate as make_table,
};
use proprio_calibration::{Error, JudgedTruth};
use proprio_session::{LoadedTable, today};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Map, Value, json};

use crate::error::exception;
use crate::findings;
use crate::interrupt::{Interruptible, interruptible};
use crate::table::TableText;

/// Makes a table; returns its text, the reports as JSON, and the warnings.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    sessions: Vec<PathBuf>,
    arm: TableText,
    maps: &str,
    hysteresis: &str,
) -> PyResult<(String, String, Vec<String>)> {
    let options = CalibrationOptions { maps: map_mode(maps)?, hysteresis: hysteresis_mode(hysteresis)? };
    let run = |progress: &mut Interruptible| {
        let made = make_table(&sessions, &arm.load()?, options, progress)?;
        let table = LoadedTable { file: made.table.clone(), path: Path::new("the table") };
        let found = findings::of_sessions(&sessions, &table, progress, |finding| !finding.is_later_tare())?;
        Ok::<_, Error>((made, found))
    };
    let (mut made, mut warnings) = interruptible(py, run)?.map_err(|error| exception(py, error))?;
    if let Some(record) = &mut made.table.calibration {
        record.date = Some(today());
    }
    let names: Vec<String> = sessions.iter().map(|session| session.display().to_string()).collect();
    for (name, defects) in names.iter().zip(&made.defects) {
        warnings.extend(defects.warnings().map(|warning| format!("{name}: {warning}")));
    }
    warnings.extend(made.truth.iter().flat_map(truth_warnings));
    warnings.extend(made.warnings.iter().map(|warning| format!("{}: {warning}", names.join(", "))));
    Ok((made.table.to_toml(), report(&made).to_string(), warnings))
}

/// Warnings about the truth of a file, each with its remedy.
pub fn truth_warnings(truth: &JudgedTruth) -> impl Iterator<Item = String> {
    let text = |finding| format!("{}: {}; {}", truth.path.display(), truth.text(finding), Help::help(finding));
    truth.findings.iter().map(text)
}

/// Lengths and clock of the truth of each file.
pub fn truth_report<'t>(truth: impl Iterator<Item = &'t JudgedTruth>) -> Value {
    let row = |truth: &JudgedTruth| {
        let scale = truth.lengths.map(|lengths| lengths.scale);
        json!({ "path": truth.path.display().to_string(), "length_scale": scale, "lag_s": truth.lag_s })
    };
    truth.map(row).collect()
}

fn map_mode(name: &str) -> PyResult<MapMode> {
    match name {
        "auto" => Ok(MapMode::Auto),
        "curve" => Ok(MapMode::Curve),
        "quadratic" => Ok(MapMode::Quadratic),
        _ => Err(PyValueError::new_err(format!("maps {name:?}, expected \"auto\", \"curve\" or \"quadratic\""))),
    }
}

fn hysteresis_mode(name: &str) -> PyResult<HysteresisMode> {
    match name {
        "auto" => Ok(HysteresisMode::Auto),
        "always" => Ok(HysteresisMode::Always),
        "never" => Ok(HysteresisMode::Never),
        _ => Err(PyValueError::new_err(format!("hysteresis {name:?}, expected \"auto\", \"always\" or \"never\""))),
    }
}

fn report(made: &Calibration) -> Value {
    let sensors: Value = made
        .sensors
        .iter()
        .map(|sensor| {
            json!({
                "name": sensor.name,
                "samples": sensor.samples,
                "rmse_deg": sensor.rmse_deg,
                "volts": sensor.volts,
                "range_deg": sensor.range_deg,
            })
        })
        .collect();
    let segments: Value = made
        .segments
        .iter()
        .map(|segment| {
            json!({
                "segment": segment.segment,
                "held_back_rmse_deg": segment.held_back_rmse_deg,
                "maps": segment.maps.iter().copied().map(map_name).collect::<Vec<_>>(),
                "imu_scale": segment.imu_scale,
            })
        })
        .collect();
    let held_out = made.held_out.as_ref().map(held_out);
    json!({ "sensors": sensors, "segments": segments, "held_out": held_out, "truth": truth_report(made.truth.iter()) })
}

fn map_name((kind, has_memory): (MapKind, bool)) -> String {
    let kind = match kind {
        MapKind::Quadratic => "quadratic",
        MapKind::Curve => "curve",
    };
    if has_memory { format!("{kind} with memory") } else { kind.to_owned() }
}

/// RMSE of the tip by the name of each method, mm.
fn held_out(held_out: &HeldOut) -> Value {
    let rmse =
        Method::ALL.iter().zip(held_out.tip_rmse_mm).map(|(method, rmse)| (method.name().to_owned(), json!(rmse)));
    json!({ "tip_rmse_mm": rmse.collect::<Map<_, _>>() })
}
