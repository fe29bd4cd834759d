//! `proprio report`: sessions replayed into one page of figures, and their numbers.
//!
//! | file | purpose |
//! |---|---|
//! | `session.rs` | the data of one session |
//! | `box_plot.rs`, `drift_error.rs`, `drift.rs`, `v_orient.rs`, `tip_error.rs`, `estimate.rs`, `coverage.rs`, `contact.rs`, `shapes.rs`, `tip_view.rs` | the figures |
//! | `downsample.rs`, `average.rs` | long sessions in bounded memory |
//! | `table_name.rs`, `comparison.rs` | identity of the table; the same sessions with another one |
//! | `plot.rs` | contents of a figure |
//! | `draw.rs`, `legend.rs`, `canvas.rs`, `page.rs`, `tables.rs`, `style.css` | drawing as SVG, on a page |
//! | `paper.rs` | the drawings as single files |
//! | `export.rs` | export as JSON and CSV |

mod average;
mod box_plot;
mod canvas;
mod comparison;
mod contact;
mod coverage;
mod downsample;
mod draw;
mod drift;
mod drift_error;
mod estimate;
mod export;
mod legend;
mod page;
mod paper;
mod plot;
mod session;
mod shapes;
mod table_name;
mod tables;
mod tip_error;
mod tip_view;
mod v_orient;

use std::path::Path;

use proprio_check::Finding;
use proprio_session::{LoadedTable, Progress};
use serde::Serialize;

pub use self::paper::PaperFigure;

use self::comparison::{Comparison, OtherTable};
use self::plot::{Figure, SMOOTHED};
use self::session::Session;
use self::table_name::TableName;
use self::v_orient::Readings;
use crate::error::Error;
use crate::metrics::ErrorMetrics;
use crate::replay::{NotComparable, SessionSummary};
use crate::session_metrics::{AllMetrics, ByMethod};

/// Builder of a report, session by session. Its memory grows with their number and not with their length.
pub struct ReportBuilder<'t> {
    table: &'t LoadedTable<'t>,
    sessions: Vec<Session>,
    all: ErrorMetrics,
    readings: Readings,
    other: Option<OtherTable<'t>>,
    command: Option<String>,
}

/// A finished report, for [`Report::html`], [`Report::json`] and [`Report::csv`].
#[derive(Debug, Serialize)]
pub struct Report {
    format: u32,
    proprio: &'static str,
    /// The command that has made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    command: Option<String>,
    table: TableName,
    #[serde(flatten)]
    numbers: AllMetrics,
    missing: Vec<String>,
    findings: Vec<SessionFinding>,
    /// The same sessions with another table.
    #[serde(skip_serializing_if = "Option::is_none")]
    comparison: Option<Comparison>,
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
        Self { table, sessions: Vec::new(), all, readings, other: None, command: None }
    }

    /// Compares the table with another one on the sessions that are added.
    ///
    /// # Errors
    /// [`Error::OtherArm`] where the arms have other segments.
    pub fn compare_with(mut self, other: &'t LoadedTable) -> Result<Self, Error> {
        self.other = Some(OtherTable::new(other, &self.table.file)?);
        Ok(self)
    }

    /// The command that the page shows.
    #[must_use]
    pub fn command(mut self, command: String) -> Self {
        self.command = Some(command);
        self
    }

    /// Replays a session in fixed point, and smooths it where the table has the bias filter.
    ///
    /// # Errors
    /// Errors of [`replay`](crate::replay::replay).
    pub fn add(&mut self, path: &Path, progress: &mut dyn Progress) -> Result<SessionSummary, Error> {
        if let Some(other) = &mut self.other {
            other.add(path, progress)?;
        }
        let session = Session::read(path, self.table, &mut self.readings, progress)?;
        self.all.append(&session.data.errors);
        let summary = session.summary.clone();
        self.sessions.push(session);
        Ok(summary)
    }

    /// Makes the figures.
    ///
    /// # Errors
    /// [`Error::File`] on an arm description.
    pub fn finish(self) -> Result<Report, Error> {
        let file = &self.table.file;
        Ok(Report {
            format: 1,
            proprio: env!("CARGO_PKG_VERSION"),
            command: self.command.clone(),
            table: TableName::new(self.table)?,
            numbers: AllMetrics {
                sessions: self.sessions.iter().map(Session::metrics).collect(),
                all: ByMethod::from(&self.all),
                length_mm: file.length_mm(),
            },
            missing: self.missing(),
            findings: self.findings(),
            figures: self.figures(),
            comparison: self.other.map(|other| other.comparison(file)).transpose()?,
        })
    }

    fn figures(&self) -> Vec<Figure> {
        let all = || self.sessions.iter().map(|s| (s.name.as_str(), s.summary.samples, &s.data));
        let blind = self.sessions.iter().filter(|session| !session.has_tip_errors());
        let compared = self.other.iter().map(|other| other.figure(self.sessions.iter()));
        let own = vec![
            box_plot::figure(all().map(|(name, _, data)| (name, &data.errors)), &self.all),
            tip_error::figure(all().map(|(name, samples, data)| (name, samples, &data.tip_errors))),
            estimate::figure(blind.map(|session| (session.name.as_str(), &session.data.places))),
            drift_error::figure(all().map(|(name, samples, data)| (name, samples, &data.drift_errors))),
            drift::figure(all().map(|(name, samples, data)| (name, samples, &data.drift))),
            coverage::figure(all().map(|(name, _, data)| (name, &data.coverage))),
            contact::figure(all().map(|(name, _, data)| (name, &data.contacts))),
            self.readings.figure(),
            shapes::figure(all().map(|(name, _, data)| (name, &data.shapes, &data.errors))),
        ];
        compared.chain(own).collect()
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
        for session in &self.sessions {
            let Session { name, data, summary, .. } = session;
            if summary.not_comparable > 0 {
                missing.push(format!("{name}: {}; their drift is not shown.", NotComparable(summary)));
            }
            let has_tips = session.has_tip_errors();
            let has_angles = data.errors.metrics().iter().any(|figures| figures.theta_rmse_deg.is_some());
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
