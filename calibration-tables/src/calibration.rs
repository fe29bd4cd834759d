//! `[calibration]`: record of a table's calibration.

use serde::{Deserialize, Serialize};

use crate::error::{FileError, ensure};

/// Record of a table's calibration. The estimator does not use it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationToml {
    /// The sessions' file names.
    pub sessions: Vec<String>,
    /// Day of the calibration, UTC: `2026-11-30`; `None` where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
}

impl CalibrationToml {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        ensure(!self.sessions.is_empty(), "calibration.sessions", &"[]", "at least one session")?;
        check_date("calibration.date", self.date.as_deref())
    }
}

/// Checks the form of a day.
pub(crate) fn check_date(key: &str, date: Option<&str>) -> Result<(), FileError> {
    let is_digit =
        |(place, letter): (usize, u8)| if [4, 7].contains(&place) { letter == b'-' } else { letter.is_ascii_digit() };
    let is_day = |date: &str| date.len() == 10 && date.bytes().enumerate().all(is_digit);
    ensure(date.is_none_or(is_day), key, &date.unwrap_or_default(), "a day, as 2026-11-30")
}
