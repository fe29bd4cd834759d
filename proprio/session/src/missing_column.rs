//! A missing column, with the likely reason.

use std::fmt;

use crate::column_names::{is_known, is_truth};
use crate::file_content::FileContent;
use crate::shown::shown;

/// Similarity (Jaro–Winkler) from which on an unknown column may be the missing one.
const SIMILAR: f64 = 0.8;

/// A column that a header does not have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingColumn {
    /// Its name.
    pub name: String,
    /// The likely reason.
    pub reason: MissingReason,
}

/// The likely reason of a missing column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MissingReason {
    /// The file has other content than is expected, or it is in another form.
    Content {
        /// Its content.
        found: FileContent,
        /// The content that is read.
        expected: FileContent,
    },
    /// An unknown column has a similar name: as it can be shown.
    Similar(String),
    /// The session has no truth.
    NoTruth,
    /// None of these.
    Unknown,
}

impl MissingColumn {
    /// The column `name` that a header with `names` does not have, in a file that should have `expected` content.
    pub(crate) fn new(name: &str, names: &[String], expected: FileContent) -> Self {
        let found = FileContent::of(names);
        let reason = if found != expected && found != FileContent::Other {
            MissingReason::Content { found, expected }
        } else if let Some(similar) = similar(name, names) {
            MissingReason::Similar(shown(similar))
        } else if is_truth(name) && !names.iter().any(|name| is_truth(name)) {
            MissingReason::NoTruth
        } else {
            MissingReason::Unknown
        };
        Self { name: name.to_owned(), reason }
    }
}

/// The unknown column whose name is most similar to `name`, with the same numbers in it.
fn similar<'n>(name: &str, names: &'n [String]) -> Option<&'n str> {
    let digits = |name: &str| name.chars().filter(char::is_ascii_digit).collect::<String>();
    let unknown = names.iter().filter(|other| !is_known(other) && digits(other) == digits(name));
    let scored = unknown.map(|other| (strsim::jaro_winkler(&other.to_lowercase(), name), other));
    let best = scored.max_by(|(a, _), (b, _)| a.total_cmp(b));
    best.filter(|(similarity, _)| *similarity >= SIMILAR).map(|(_, other)| other.as_str())
}

impl fmt::Display for MissingColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {} is missing", self.name)?;
        match &self.reason {
            MissingReason::Content { found, .. } => write!(f, "; {found}"),
            MissingReason::Similar(other) => write!(f, "; did you mean {other}?"),
            MissingReason::NoTruth => f.write_str("; the session has no truth"),
            MissingReason::Unknown => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::MissingColumn;
    use crate::file_content::FileContent;

    #[test]
    fn a_similar_name_is_shown_without_its_control_characters() {
        let names = ["time_s", "truth2_x_m\u{5}time_s"].map(str::to_owned);
        let message = MissingColumn::new("truth2_x_mm", &names, FileContent::Session).to_string();
        assert_eq!(message, "column truth2_x_mm is missing; did you mean truth2_x_m\\u{5}time_s?");
    }
}
