//! Alignment of a camera's clock.

use std::path::PathBuf;

use proprio_calibration::Error;
use proprio_calibration::align::{AlignmentReport, ComparedSensors, align as align_clocks};
use proprio_session::{Axis, BodySelection, Existing, OutputFile};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::calibrate::{truth_report, truth_warnings};
use crate::error::exception;
use crate::findings;
use crate::interrupt::{Interruptible, interruptible};
use crate::table::TableText;

/// Writes the session with truth to `output`; returns the report as JSON, and the warnings.
#[pyfunction]
pub fn align(
    py: Python<'_>,
    session: PathBuf,
    camera: PathBuf,
    arm: TableText,
    output: PathBuf,
    bodies: Vec<String>,
    up: Option<&str>,
) -> PyResult<(String, Vec<String>)> {
    let selection = BodySelection { names: bodies, up: up.map(axis).transpose()? };
    let run = |progress: &mut Interruptible| {
        let mut file = OutputFile::create(&output, &[&session, &camera], Existing::Keep)?;
        let arm = arm.load()?;
        let alignment = align_clocks(&session, &camera, &selection, &arm, progress)?;
        let sessions = std::slice::from_ref(&session);
        let mut warnings = findings::of_sessions(sessions, &arm, progress, |_| true)?;
        for (path, defects) in [&session, &camera].into_iter().zip(&alignment.defects) {
            warnings.extend(defects.warnings().map(|warning| format!("{}: {warning}", path.display())));
        }
        warnings.extend(truth_warnings(alignment.truth()));
        let written = alignment.write(&session, &mut file)?;
        file.finish()?;
        let mut report = report(&alignment.report);
        report["bodies"] = json!(alignment.bodies());
        report["rows"] = json!(written.rows);
        report["rows_with_truth"] = json!(written.with_truth);
        report["truth"] = truth_report([alignment.truth()].into_iter());
        Ok::<_, Error>((report.to_string(), warnings))
    };
    interruptible(py, run)?.map_err(|error| exception(py, error))
}

/// An axis by its letter.
fn axis(name: &str) -> PyResult<Axis> {
    match name {
        "x" => Ok(Axis::X),
        "y" => Ok(Axis::Y),
        "z" => Ok(Axis::Z),
        _ => Err(PyValueError::new_err(format!("up = \"{name}\", expected \"x\", \"y\" or \"z\""))),
    }
}

fn report(report: &AlignmentReport) -> Value {
    let sensors = match report.sensors {
        ComparedSensors::Imus => "imus",
        ComparedSensors::Bend => "bend sensors",
    };
    json!({
        "sensors": sensors,
        "offset_s": report.offset_s,
        "offset_error_ms": report.offset_error_ms,
        "middle_s": report.middle_s,
        "skew_ppm": report.skew_ppm,
        "skew_error_ppm": report.skew_error_ppm,
        "residual_ms": report.residual_ms,
        "correlation": report.correlation,
        "matched": report.matched,
    })
}
