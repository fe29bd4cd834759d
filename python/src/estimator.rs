//! The estimator, sample by sample.

use estimator_core::{ArmConfig, Estimator, FusedOps, Q};
use proprio_analysis::{HostEstimator, Outcome};
use proprio_session::{Error, LoadedTable, Row};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{exception, with_help};
use crate::estimates::Estimates;
use crate::rows::{SessionArrays, SessionRows};
use crate::table::TableText;

/// An estimator of one arm. Its configuration, which it borrows, stays in memory until the process ends.
#[pyclass(name = "Estimator")]
pub struct PyEstimator {
    estimator: AnyEstimator,
    segments: usize,
    /// Time of the last sample, µs.
    last_us: Option<u64>,
}

/// An estimator in the board's fixed point or in floats.
enum AnyEstimator {
    Fixed(Box<HostEstimator<'static, Q>>),
    Float(Box<HostEstimator<'static, f64>>),
}

fn estimator<S: FusedOps + 'static>(
    table: &LoadedTable,
    rate_hz: f64,
) -> Result<Box<HostEstimator<'static, S>>, Error> {
    let compiled = Box::leak(Box::new(table.compile::<S>(rate_hz)?));
    let config: &'static ArmConfig<'static, S> = Box::leak(Box::new(compiled.config()));
    Ok(Box::new(Estimator::new(config).expect("the file was checked")))
}

#[pymethods]
impl PyEstimator {
    /// An estimator at the start of a session; `rate_hz` is the table's where it is not given.
    #[new]
    fn new(py: Python<'_>, table: TableText, rate_hz: Option<f64>, is_float: bool) -> PyResult<Self> {
        let make = || {
            let table = table.load()?;
            let rate_hz = rate_hz.unwrap_or(table.file.rate_hz);
            let estimator = if is_float {
                AnyEstimator::Float(estimator(&table, rate_hz)?)
            } else {
                AnyEstimator::Fixed(estimator(&table, rate_hz)?)
            };
            Ok::<_, Error>(Self { estimator, segments: table.file.segments.len(), last_us: None })
        };
        make().map_err(|error| exception(py, error))
    }

    /// Starts a session; clears the state of the one before.
    fn start(&mut self) {
        let started = match &mut self.estimator {
            AnyEstimator::Fixed(estimator) => estimator.start(),
            AnyEstimator::Float(estimator) => estimator.start(),
        };
        started.expect("the estimator has room for its table");
        self.last_us = None;
    }

    /// Processes samples; returns their estimates.
    fn run<'py>(&mut self, py: Python<'py>, arrays: SessionArrays) -> PyResult<Bound<'py, PyDict>> {
        if arrays.segments() != self.segments {
            let text = format!("the arrays have {} segments, the table has {}", arrays.segments(), self.segments);
            return Err(with_help(py, &text, "give the readings of the table's arm"));
        }
        let SessionRows { rows, .. } = arrays.rows(py, self.last_us)?;
        self.last_us = rows.last().map_or(self.last_us, |row| Some(row.sample.time_us));
        let (segments, estimator) = (self.segments, &mut self.estimator);
        let estimates = py.detach(|| match estimator {
            AnyEstimator::Fixed(estimator) => estimates(estimator, segments, &rows),
            AnyEstimator::Float(estimator) => estimates(estimator, segments, &rows),
        });
        estimates.into_arrays().into_dict(py)
    }
}

fn estimates<S: FusedOps>(estimator: &mut HostEstimator<'_, S>, segments: usize, rows: &[Row]) -> Estimates {
    let mut estimates = Estimates::new(segments);
    for row in rows {
        estimates.add(&Outcome::of_row(estimator, row));
    }
    estimates
}
