//! Identity and history of a table.

use calibration_tables::{CalibrationToml, TuningToml};
use estimator_core::Q;
use proprio_session::LoadedTable;
use serde::Serialize;

use crate::error::Error;

/// Identity of the table.
#[derive(Debug, Serialize)]
pub struct TableName {
    pub path: String,
    pub arm: String,
    /// CRC-32 of its parameters at its `rate_hz`.
    pub crc32: String,
    pub rate_hz: f64,
    pub segments: usize,
    pub length_mm: f64,
    /// Sessions and day of the calibration, where they are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationToml>,
    /// Sessions and day of the tuning, where it was tuned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tuning: Option<TuningToml>,
}

impl TableName {
    pub fn new(table: &LoadedTable) -> Result<Self, Error> {
        let file = &table.file;
        let crc32 = table.compile::<Q>(file.rate_hz)?.checksum();
        Ok(Self {
            path: table.path.display().to_string(),
            arm: file.arm.clone(),
            crc32: format!("{crc32:08x}"),
            rate_hz: file.rate_hz,
            segments: file.segments.len(),
            length_mm: file.length_mm(),
            calibration: file.calibration.clone(),
            tuning: file.tuning.clone(),
        })
    }

    /// Text about the sessions that it was made of, in front of which other text stands.
    pub fn text_of_history(&self) -> String {
        let part = |what: &str, sessions: &[String], date: Option<&String>| {
            let date = date.map_or_else(String::new, |date| format!(" on {date}"));
            format!("; {what} {}{date}", sessions.join(", "))
        };
        let calibration = self.calibration.as_ref().map(|of| part("calibrated from", &of.sessions, of.date.as_ref()));
        let tuning = self.tuning.as_ref().map(|of| part("tuned on", &of.sessions, of.date.as_ref()));
        let unknown = || "; without a record of its calibration".to_owned();
        calibration.unwrap_or_else(unknown) + &tuning.unwrap_or_default()
    }
}
