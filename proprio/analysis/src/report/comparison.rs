//! Comparison of the report's table with another one, on the same sessions.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::Method;
use proprio_session::{LoadedTable, Progress};
use serde::Serialize;
use serde_json::Value;

use super::plot::{Axis, Colour, Figure, Panel, Series, Size, extent, share_y};
use super::session::{Session, replayed};
use super::table_name::TableName;
use super::tip_error::TipErrors;
use crate::error::Error;
use crate::metrics::ErrorMetrics;
use crate::session_metrics::{ByMethod, SessionMetrics};

/// Replays of the sessions with another table.
pub struct OtherTable<'t> {
    table: &'t LoadedTable<'t>,
    sessions: Vec<OtherSession>,
    all: ErrorMetrics,
}

struct OtherSession {
    metrics: SessionMetrics,
    tip_errors: TipErrors,
}

/// The comparison: the other table's metrics, and the parameters that differ.
#[derive(Debug, Serialize)]
pub struct Comparison {
    pub table: TableName,
    pub sessions: Vec<SessionMetrics>,
    pub all: ByMethod,
    pub differences: Vec<Difference>,
}

/// A key of which the tables have different values.
#[derive(Debug, Serialize)]
pub struct Difference {
    pub key: String,
    /// Value of the report's table; `None` where it has no such key.
    pub table: Option<Value>,
    /// Value of the other one.
    pub other: Option<Value>,
}

impl<'t> OtherTable<'t> {
    /// No session yet. The table is one of the same arm as `reports`, that of the report.
    pub fn new(table: &'t LoadedTable, reports: &ArmFile) -> Result<Self, Error> {
        let lengths_mm = |file: &ArmFile| -> Vec<f64> {
            file.segments.iter().flat_map(|segment| [segment.length_mm, segment.offset_mm]).collect()
        };
        if lengths_mm(&table.file) != lengths_mm(reports) {
            return Err(Error::OtherArm(table.path.to_owned()));
        }
        Ok(Self { table, sessions: Vec::new(), all: ErrorMetrics::new(table.file.length_mm()) })
    }

    /// Replays a session.
    pub fn add(&mut self, path: &Path, progress: &mut dyn Progress) -> Result<(), Error> {
        let mut errors = ErrorMetrics::new(self.table.file.length_mm());
        let mut tip_errors = TipErrors::new();
        let summary = replayed(path, self.table, progress, |row, outcome| {
            errors.add(row, outcome);
            tip_errors.add(row, outcome);
        })?;
        self.all.append(&errors);
        let metrics = SessionMetrics {
            path: path.display().to_string(),
            samples: summary.samples,
            seconds: summary.seconds,
            metrics: ByMethod::from(&errors),
            recorded_at: summary.recorded_at,
            recorded: None,
        };
        self.sessions.push(OtherSession { metrics, tip_errors });
        Ok(())
    }

    /// The figure of the tip errors of fusion by both tables.
    pub fn figure<'s>(&self, sessions: impl Iterator<Item = &'s Session>) -> Figure {
        let pairs = sessions.zip(&self.sessions);
        let panels = pairs.filter_map(|(session, other)| {
            let tables = [
                ("fusion by table A", Colour::Of(Method::Fusion), &session.data.tip_errors),
                ("fusion by table B", Colour::Ink, &other.tip_errors),
            ];
            let known = tables.into_iter().filter(|(.., errors)| errors.has(Method::Fusion));
            let series = |(name, colour, errors): (&str, Colour, &TipErrors)| Series {
                name: name.to_owned(),
                colour,
                marks: errors.mean(Method::Fusion as usize),
            };
            panel(&session.name, known.map(series).collect())
        });
        let mut panels: Vec<Panel> = panels.collect();
        share_y(panels.iter_mut());
        Figure {
            name: "comparison",
            title: "Tip error of fusion by two tables",
            caption: "Distance of the tip from its true place, means over bins of equally many samples. All panels have one scale."
                .to_owned(),
            is_drawn: !panels.is_empty(),
            panels,
        }
    }

    /// The comparison with `table`.
    pub fn comparison(self, table: &ArmFile) -> Result<Comparison, Error> {
        Ok(Comparison {
            table: TableName::new(self.table)?,
            sessions: self.sessions.into_iter().map(|session| session.metrics).collect(),
            all: ByMethod::from(&self.all),
            differences: differences(table, &self.table.file),
        })
    }
}

fn panel(session: &str, series: Vec<Series>) -> Option<Panel> {
    let [x, [_, largest]] = extent(&series);
    (!series.is_empty()).then(|| Panel {
        session: Some(session.to_owned()),
        name: String::new(),
        title: session.to_owned(),
        facts: Vec::new(),
        size: Size::Half,
        x: Axis::new("time, s", x),
        y: Axis::new("tip error, mm", [0.0, 1.05 * largest]),
        series,
    })
}

/// The keys of different values, without the records of calibration and tuning.
fn differences(table: &ArmFile, other: &ArmFile) -> Vec<Difference> {
    let values = [table, other].map(|file| {
        let parameters = ArmFile { calibration: None, tuning: None, ..file.clone() };
        serde_json::to_value(parameters).unwrap_or_default()
    });
    let mut found = Vec::new();
    let [table, other] = &values;
    compare(String::new(), Some(table), Some(other), &mut found);
    found
}

fn compare(key: String, table: Option<&Value>, other: Option<&Value>, found: &mut Vec<Difference>) {
    match (table, other) {
        (Some(Value::Object(table)), Some(Value::Object(other))) => {
            let missing = other.keys().filter(|name| !table.contains_key(*name));
            for name in table.keys().chain(missing) {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                compare(key, table.get(name), other.get(name), found);
            }
        }
        (Some(Value::Array(table)), Some(Value::Array(other))) if is_nested(table) || is_nested(other) => {
            for i in 0..table.len().max(other.len()) {
                compare(format!("{key}[{}]", i + 1), table.get(i), other.get(i), found);
            }
        }
        _ if table == other => {}
        _ => found.push(Difference { key, table: table.cloned(), other: other.cloned() }),
    }
}

fn is_nested(values: &[Value]) -> bool {
    values.iter().any(Value::is_object)
}
