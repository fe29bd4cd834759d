//! The content of a text file by its first line, for errors about a file in place of another.

use std::fmt;

use crate::column_names::{is_pressure, is_truth, segment_of};

/// Separators of other programs' tables.
const SEPARATORS: [(char, &str); 3] = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars")];

/// The content of a text file, by the names in its first line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileContent {
    /// Readings of an arm's sensors.
    Session,
    /// Poses of markers, without readings.
    Camera,
    /// Pressures over time, without readings.
    Profile,
    /// Estimates of a replay.
    Estimates,
    /// An arm description or a table.
    Table,
    /// A page for a browser.
    Html,
    /// A line `sep=` of a spreadsheet program in front of the header.
    SeparatorLine,
    /// Columns between these characters, by their name, in place of commas.
    Separated(&'static str),
    /// None of these.
    Other,
}

impl FileContent {
    /// Classifies the names between the commas of a file's first line.
    pub(crate) fn of(names: &[String]) -> Self {
        let first = names.first().map_or("", String::as_str);
        let any = |is: fn(&str) -> bool| names.iter().any(|name| is(name));
        let separator = SEPARATORS.iter().find(|(separator, _)| first.contains(*separator));
        if first.starts_with("sep=") {
            Self::SeparatorLine
        } else if first.starts_with('<') {
            Self::Html
        } else if first.starts_with(['#', '[']) || first.contains(" = ") {
            Self::Table
        } else if let Some((_, name)) = separator {
            Self::Separated(name)
        } else if any(is_reading) {
            Self::Session
        } else if any(is_truth) {
            Self::Camera
        } else if any(is_pressure) {
            Self::Profile
        } else if any(|name| name.starts_with("fusion1_")) {
            Self::Estimates
        } else {
            Self::Other
        }
    }
}

/// True for a column of a sensor.
fn is_reading(name: &str) -> bool {
    segment_of(name).is_some_and(|segment| segment > 0) && !is_truth(name)
}

impl fmt::Display for FileContent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Session => f.write_str("the file is a session: it has columns of sensors"),
            Self::Camera => f.write_str("the file is a camera's: it has columns of truth and none of sensors"),
            Self::Profile => f.write_str("the file is a profile: it has columns of pressures and none of sensors"),
            Self::Estimates => f.write_str("the file has the estimates of a replay"),
            Self::Table => f.write_str("the file is an arm description or a table"),
            Self::Html => f.write_str("the file is a page for a browser"),
            Self::SeparatorLine => f.write_str("the first line is that of a spreadsheet program, sep="),
            Self::Separated(name) => write!(f, "the columns are between {name}"),
            Self::Other => f.write_str("the columns are of another kind"),
        }
    }
}
