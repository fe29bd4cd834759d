//! Errors of arm descriptions and tables, and the checks of single values.

use std::ops::RangeInclusive;

/// The `format` that this crate reads and writes.
pub(crate) const FORMAT: u32 = 1;
/// Size of the largest file, bytes.
pub(crate) const MAX_BYTES: u64 = 1 << 20;

/// Reason why a file is rejected as an arm description or table.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// The file is larger than any table.
    #[error("is larger than {MAX_BYTES} bytes, which no arm description or table is")]
    Size,
    /// The file is not TOML, or a key is missing, unknown or of the wrong type.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// Description of the error.
        message: String,
    },
    /// The format number is not that of this version.
    #[error("format = {0} is not known; this version reads format = {FORMAT}")]
    Format(u32),
    /// A value that the estimator cannot use.
    #[error("{}{key} = {found}, expected {expected}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Value {
        /// Line, from 1, if the key is in the file.
        line: Option<usize>,
        /// Path of the key, such as `segment[2].bend[1].volts`, counted from 1.
        key: String,
        /// The value.
        found: String,
        /// Valid values.
        expected: String,
    },
    /// An arm description in place of a table.
    #[error("segment[{0}] has no key `bend`: this is an arm description, not a table")]
    NotCalibrated(usize),
}

pub(crate) fn ensure(holds: bool, key: &str, found: &impl ToString, expected: &str) -> Result<(), FileError> {
    if holds {
        return Ok(());
    }
    Err(FileError::Value { line: None, key: key.to_owned(), found: found.to_string(), expected: expected.to_owned() })
}

/// Checks that a value is within a range; NaN is within no range.
pub(crate) fn within(key: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), FileError> {
    ensure(range.contains(&value), key, &format!("{value:?}"), &format!("{:?} to {:?}", range.start(), range.end()))
}
