//! `proprio report`: sessions replayed into one page of figures, and the numbers behind them.
//!
//! | file | |
//! |---|---|
//! | `boxes.rs`, `drift.rs`, `v_orient.rs`, `tip_error.rs`, `shapes.rs` | the figures |
//! | `thin.rs`, `average.rs` | long sessions in bounded memory |
//! | `plot.rs` | what a figure shows |
//! | `draw.rs`, `legend.rs`, `page.rs`, `style.css` | as SVG, on a page |
//! | `export.rs` | as JSON and CSV |

mod average;
mod boxes;
mod draw;
mod drift;
mod export;
mod legend;
mod page;
mod plot;
mod shapes;
mod thin;
mod tip_error;
mod v_orient;

use std::path::Path;

use estimator_core::{Method, Q};
use proprio_session::{NamedTable, Progress, Row};
use serde::Serialize;

use self::drift::Drift;
use self::plot::Figure;
use self::shapes::Shapes;
use self::tip_error::TipErrors;
use self::v_orient::Readings;
use crate::error::Error;
use crate::figures::{AllFigures, ByMethod, SessionFigures};
use crate::metrics::Score;
use crate::outcome::Outcome;
use crate::replay::{Extent, replay};
use crate::smooth;

/// A report that is being gathered, session by session. Its memory grows with their number and not with their length.
pub struct Gathering<'t> {
    table: &'t NamedTable<'t>,
    sessions: Vec<Session>,
    all: Score,
    readings: Readings,
}

/// What is kept of one session.
struct Session {
    name: String,
    extent: Extent,
    score: Score,
    drift: Drift,
    tip_errors: TipErrors,
    shapes: Shapes,
}

/// A finished report: what [`Report::html`], [`Report::json`] and [`Report::csv`] say in three ways.
#[derive(Debug, Serialize)]
pub struct Report {
    format: u32,
    proprio: &'static str,
    table: TableName,
    #[serde(flatten)]
    numbers: AllFigures,
    missing: Vec<String>,
    figures: Vec<Figure>,
}

/// Which table it is.
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

impl<'t> Gathering<'t> {
    /// No session yet.
    #[must_use]
    pub fn new(table: &'t NamedTable) -> Self {
        let (all, readings) = (Score::new(table.file.length_mm()), Readings::new(&table.file));
        Self { table, sessions: Vec::new(), all, readings }
    }

    /// Replays a session in fixed point, and smooths it where the table has the bias filter.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn add(&mut self, path: &Path, progress: &mut dyn Progress) -> Result<Extent, Error> {
        let table = &self.table.file;
        let mut score = Score::new(table.length_mm());
        let (mut drift, mut tip_errors, mut shapes) = (Drift::new(table), TipErrors::new(), Shapes::new(table));
        let readings = &mut self.readings;
        let visit = |row: &Row, outcome: &Outcome<Q>| {
            score.add(row, outcome);
            drift.add(row, outcome);
            tip_errors.add(row, outcome);
            shapes.add(row, outcome);
            readings.add(row);
            Ok(())
        };
        let extent = if self.table.has_bias_filter() {
            smooth::replay(path, self.table, progress, visit)?
        } else {
            replay(path, self.table, progress, visit)?
        };
        self.all.append(&score);
        let name = path.display().to_string();
        self.sessions.push(Session { name, extent: extent.clone(), score, drift, tip_errors, shapes });
        Ok(extent)
    }

    /// Makes the figures.
    ///
    /// # Errors
    /// [`Error::File`] on an arm description.
    pub fn finish(self) -> Result<Report, Error> {
        let Self { table: NamedTable { file, path }, sessions, all, readings } = &self;
        let of_session = |session: &Session| SessionFigures {
            path: session.name.clone(),
            samples: session.extent.samples,
            seconds: session.extent.seconds,
            figures: ByMethod::from(&session.score),
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
            numbers: AllFigures {
                sessions: sessions.iter().map(of_session).collect(),
                all: ByMethod::from(all),
                length_mm: file.length_mm(),
            },
            missing: self.missing(),
            figures: vec![
                boxes::figure(sessions.iter().map(|s| (s.name.as_str(), &s.score)), all),
                drift::figure(sessions.iter().map(|s| (s.name.as_str(), s.extent.samples, &s.drift))),
                readings.figure(),
                tip_error::figure(sessions.iter().map(|s| (s.name.as_str(), s.extent.samples, &s.tip_errors))),
                shapes::figure(sessions.iter().map(|s| (s.name.as_str(), &s.shapes, &s.score))),
            ],
        })
    }

    /// What a reader would look for in vain, and why.
    fn missing(&self) -> Vec<String> {
        let mut missing = Vec::new();
        if self.table.file.segments.iter().all(|segment| segment.bend.iter().flatten().next().is_none()) {
            missing.push(
                "The table has no bend sensors: only imu_o speaks, nothing corrects its drift, and there is no V–Orient map."
                    .to_owned(),
            );
        }
        for Session { name, score, .. } in &self.sessions {
            let has_tips = Method::ALL.iter().any(|method| score.tips(*method).count() > 0);
            let has_angles = score.figures().iter().any(|figures| figures.theta_rmse_deg.is_some());
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
