//! `proprio report`: sessions replayed into one page of figures, and their numbers.
//!
//! | file | purpose |
//! |---|---|
//! | `box_plot.rs`, `drift_error.rs`, `drift.rs`, `v_orient.rs`, `tip_error.rs`, `shapes.rs` | the figures |
//! | `downsample.rs`, `average.rs` | long sessions in bounded memory |
//! | `plot.rs` | contents of a figure |
//! | `draw.rs`, `legend.rs`, `canvas.rs`, `page.rs`, `style.css` | drawing as SVG, on a page |
//! | `paper.rs` | the drawings as single files |
//! | `export.rs` | export as JSON and CSV |

mod average;
mod box_plot;
mod canvas;
mod downsample;
mod draw;
mod drift;
mod drift_error;
mod export;
mod legend;
mod page;
mod paper;
mod plot;
mod shapes;
mod tip_error;
mod v_orient;

use std::path::Path;

use estimator_core::{Method, Q};
use proprio_session::{LoadedTable, Progress, Row};
use serde::Serialize;

pub use self::paper::PaperFigure;

use self::drift::Drift;
use self::drift_error::DriftErrors;
use self::plot::Figure;
use self::shapes::Shapes;
use self::tip_error::TipErrors;
use self::v_orient::Readings;
use crate::error::Error;
use crate::metrics::ErrorMetrics;
use crate::outcome::Outcome;
use crate::replay::{NotComparable, SessionSummary, replay};
use crate::session_metrics::{AllMetrics, ByMethod, SessionMetrics};
use crate::smooth;
use proprio_check::{Finding, SessionCheck};

/// Builder of a report, session by session. Its memory grows with their number and not with their length.
pub struct ReportBuilder<'t> {
    table: &'t LoadedTable<'t>,
    sessions: Vec<Session>,
    all: ErrorMetrics,
    readings: Readings,
}

/// Data of one session.
struct Session {
    name: String,
    summary: SessionSummary,
    errors: ErrorMetrics,
    drift: Drift,
    drift_errors: DriftErrors,
    tip_errors: TipErrors,
    shapes: Shapes,
    findings: Vec<Finding>,
}

/// A finished report, for [`Report::html`], [`Report::json`] and [`Report::csv`].
#[derive(Debug, Serialize)]
pub struct Report {
    format: u32,
    proprio: &'static str,
    table: TableName,
    #[serde(flatten)]
    numbers: AllMetrics,
    missing: Vec<String>,
    findings: Vec<SessionFinding>,
    figures: Vec<Figure>,
}

/// A finding of the session check.
#[derive(Debug, Serialize)]
struct SessionFinding {
    session: String,
    text: String,
    #[serde(flatten)]
    finding: Finding,
}

/// Identity of the table.
#[derive(Debug, Serialize)]
struct TableName {
    path: String,
    arm: String,
    /// CRC-32 of its parameters at its `rate_hz`.
    crc32: String,
    rate_hz: f64,
    segments: usize,
    length_mm: f64,
}

impl Report {
    /// The plots of the page, each as a drawing of its own for a paper.
    #[must_use]
    pub fn paper_figures(&self) -> Vec<PaperFigure> {
        paper::figures(&self.figures)
    }
}

impl<'t> ReportBuilder<'t> {
    /// No session yet.
    #[must_use]
    pub fn new(table: &'t LoadedTable) -> Self {
        let (all, readings) = (ErrorMetrics::new(table.file.length_mm()), Readings::new(&table.file));
        Self { table, sessions: Vec::new(), all, readings }
    }

    /// Replays a session in fixed point, and smooths it where the table has the bias filter.
    ///
    /// # Errors
    /// Errors of [`replay`].
    pub fn add(&mut self, path: &Path, progress: &mut dyn Progress) -> Result<SessionSummary, Error> {
        let table = &self.table.file;
        let mut errors = ErrorMetrics::new(table.length_mm());
        let (mut drift, mut drift_errors) = (Drift::new(table), DriftErrors::new(table));
        let (mut tip_errors, mut shapes) = (TipErrors::new(), Shapes::new(table));
        let readings = &mut self.readings;
        let mut check = SessionCheck::new(self.table)?;
        let visit = |row: &Row, outcome: &Outcome<Q>| {
            check.update(row);
            errors.add(row, outcome);
            if row.is_comparable() {
                drift.add(row, outcome);
                drift_errors.add(row, outcome);
            }
            tip_errors.add(row, outcome);
            shapes.add(row, outcome);
            readings.add(row);
            Ok(())
        };
        let summary = if self.table.has_bias_filter() {
            smooth::replay(path, self.table, progress, visit)?
        } else {
            replay(path, self.table, progress, visit)?
        };
        self.all.append(&errors);
        let name = path.display().to_string();
        self.sessions.push(Session {
            name,
            summary: summary.clone(),
            errors,
            drift,
            drift_errors,
            tip_errors,
            shapes,
            findings: check.findings(),
        });
        Ok(summary)
    }

    /// Makes the figures.
    ///
    /// # Errors
    /// [`Error::File`] on an arm description.
    pub fn finish(self) -> Result<Report, Error> {
        let Self { table: LoadedTable { file, path }, sessions, all, readings } = &self;
        let of_session = |session: &Session| SessionMetrics {
            path: session.name.clone(),
            samples: session.summary.samples,
            seconds: session.summary.seconds,
            metrics: ByMethod::from(&session.errors),
            recorded: None,
        };
        let crc32 = self.table.compile::<Q>(file.rate_hz)?.checksum();
        Ok(Report {
            format: 1,
            proprio: env!("CARGO_PKG_VERSION"),
            table: TableName {
                path: path.display().to_string(),
                arm: file.arm.clone(),
                crc32: format!("{crc32:08x}"),
                rate_hz: file.rate_hz,
                segments: file.segments.len(),
                length_mm: file.length_mm(),
            },
            numbers: AllMetrics {
                sessions: sessions.iter().map(of_session).collect(),
                all: ByMethod::from(all),
                length_mm: file.length_mm(),
            },
            missing: self.missing(),
            findings: self.findings(),
            figures: vec![
                box_plot::figure(sessions.iter().map(|s| (s.name.as_str(), &s.errors)), all),
                drift_error::figure(sessions.iter().map(|s| (s.name.as_str(), s.summary.samples, &s.drift_errors))),
                drift::figure(sessions.iter().map(|s| (s.name.as_str(), s.summary.samples, &s.drift))),
                readings.figure(),
                tip_error::figure(sessions.iter().map(|s| (s.name.as_str(), s.summary.samples, &s.tip_errors))),
                shapes::figure(sessions.iter().map(|s| (s.name.as_str(), &s.shapes, &s.errors))),
            ],
        })
    }

    /// Findings of all sessions.
    fn findings(&self) -> Vec<SessionFinding> {
        let of_session = |session: &Session| {
            let name = session.name.clone();
            let found = session.findings.clone().into_iter();
            found.map(move |finding| SessionFinding { session: name.clone(), text: finding.to_string(), finding })
        };
        self.sessions.iter().flat_map(of_session).collect()
    }

    /// Notes about results that are missing, with the reason.
    fn missing(&self) -> Vec<String> {
        let mut missing = Vec::new();
        if self.table.file.segments.iter().all(|segment| segment.bend.iter().flatten().next().is_none()) {
            missing.push(
                "The table has no bend sensors: there is only imu_o, without correction of its drift, and no V–Orient map."
                    .to_owned(),
            );
        }
        for Session { name, errors, summary, .. } in &self.sessions {
            if summary.not_comparable > 0 {
                missing.push(format!("{name}: {}; their drift is not shown.", NotComparable(summary)));
            }
            let has_tips = Method::ALL.iter().any(|method| errors.tips(*method).count() > 0);
            let has_angles = errors.metrics().iter().any(|figures| figures.theta_rmse_deg.is_some());
            match (has_tips, has_angles) {
                (true, true) => {}
                (false, false) => missing.push(format!("{name} has no truth: its errors are not known.")),
                (true, false) => missing
                    .push(format!("{name} has true places without headings: errors of its bend angles are not known.")),
                (false, true) => missing.push(format!(
                    "{name} has no true place of the tip while an estimate is there: its tip errors are not known."
                )),
            }
        }
        missing
    }
}
