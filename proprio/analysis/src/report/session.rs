//! Data of one session of a report, row by row.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::Q;
use proprio_check::{Finding, SessionCheck};
use proprio_session::{LoadedTable, Progress, Row};

use super::contact::Contacts;
use super::coverage::Coverage;
use super::drift::Drift;
use super::drift_error::DriftErrors;
use super::estimate::TipPlaces;
use super::shapes::Shapes;
use super::tip_error::TipErrors;
use super::v_orient::Readings;
use crate::error::Error;
use crate::metrics::ErrorMetrics;
use crate::outcome::Outcome;
use crate::replay::{SessionSummary, replay};
use crate::session_metrics::{ByMethod, SessionMetrics};
use crate::smooth;

/// A replayed session.
pub struct Session {
    pub name: String,
    pub summary: SessionSummary,
    pub data: Data,
    pub findings: Vec<Finding>,
}

/// Data of its rows.
pub struct Data {
    pub errors: ErrorMetrics,
    pub drift: Drift,
    pub drift_errors: DriftErrors,
    pub tip_errors: TipErrors,
    pub coverage: Coverage,
    pub places: TipPlaces,
    pub contacts: Contacts,
    pub shapes: Shapes,
}

impl Data {
    fn new(table: &ArmFile) -> Self {
        Self {
            errors: ErrorMetrics::new(table.length_mm()),
            drift: Drift::new(table),
            drift_errors: DriftErrors::new(table),
            tip_errors: TipErrors::new(),
            coverage: Coverage::new(),
            places: TipPlaces::new(),
            contacts: Contacts::new(table),
            shapes: Shapes::new(table),
        }
    }

    fn add(&mut self, row: &Row, outcome: &Outcome<Q>) {
        self.errors.add(row, outcome);
        if row.is_comparable() {
            self.drift.add(row, outcome);
            self.drift_errors.add(row, outcome);
        }
        self.tip_errors.add(row, outcome);
        self.coverage.add(row, outcome);
        self.places.add(row, outcome);
        self.contacts.add(row, outcome);
        self.shapes.add(row, outcome);
    }
}

impl Session {
    /// Replays a session, and smooths it where the table has the bias filter.
    pub fn read(
        path: &Path,
        table: &LoadedTable,
        readings: &mut Readings,
        progress: &mut dyn Progress,
    ) -> Result<Self, Error> {
        let (mut data, mut check) = (Data::new(&table.file), SessionCheck::new(table)?);
        let summary = replayed(path, table, progress, |row, outcome| {
            check.update(row);
            data.add(row, outcome);
            readings.add(row);
        })?;
        Ok(Self { name: path.display().to_string(), summary, data, findings: check.findings() })
    }

    /// True where the place of the tip is known and estimated.
    pub fn has_tip_errors(&self) -> bool {
        estimator_core::Method::ALL.iter().any(|method| self.data.errors.tips(*method).count() > 0)
    }

    pub fn metrics(&self) -> SessionMetrics {
        SessionMetrics {
            path: self.name.clone(),
            samples: self.summary.samples,
            seconds: self.summary.seconds,
            metrics: ByMethod::from(&self.data.errors),
            recorded_at: self.summary.recorded_at.clone(),
            recorded: None,
        }
    }
}

/// Replays a session in fixed point, smoothed where the table has the bias filter.
pub fn replayed(
    path: &Path,
    table: &LoadedTable,
    progress: &mut dyn Progress,
    mut visit: impl FnMut(&Row, &Outcome<Q>),
) -> Result<SessionSummary, Error> {
    let visit = |row: &Row, outcome: &Outcome<Q>| {
        visit(row, outcome);
        Ok(())
    };
    if table.has_bias_filter() {
        smooth::replay(path, table, progress, visit)
    } else {
        replay(path, table, progress, visit)
    }
}
