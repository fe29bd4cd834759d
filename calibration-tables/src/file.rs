//! Reading and writing of the TOML file, without loss.

use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml_edit::{DocumentMut, Item, Value};

use crate::arm::ArmFile;
use crate::error::{FORMAT, FileError, MAX_BYTES};
use crate::span::{line_and_column, line_of};

impl ArmFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Any [`FileError`] but [`FileError::NotCalibrated`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let mut text = String::new();
        std::fs::File::open(path)?.take(MAX_BYTES + 1).read_to_string(&mut text)?;
        if text.len() as u64 > MAX_BYTES { Err(FileError::Size) } else { Self::parse(&text) }
    }

    /// Parses and checks a file's text; a byte-order mark is accepted.
    ///
    /// # Errors
    /// As [`ArmFile::load`].
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let text = text.trim_start_matches('\u{feff}');
        let version: Version = read(text)?;
        if version.format != FORMAT {
            return Err(FileError::Format(version.format));
        }
        let file: Self = read(text)?;
        file.check().map_err(|error| match error {
            FileError::Value { key, found, expected, .. } => {
                FileError::Value { line: line_of(text, &key), key, found, expected }
            }
            other => other,
        })?;
        Ok(file)
    }

    /// The file's text, from which [`ArmFile::parse`] gets the same values back to the last bit.
    ///
    /// # Panics
    /// Never: every value of the format has a form in TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut document = toml_edit::ser::to_document(self).expect("every value of the format has a form in TOML");
        // Tables for the outermost keys and those of `[board]`, one line for each sensor and filter in them.
        for (_, item) in document.iter_mut() {
            unfold(item);
        }
        unfold_board(&mut document);
        document.to_string()
    }
}

/// Makes a table of an inline table, or of each in a list of them.
fn unfold(item: &mut Item) {
    *item = match std::mem::take(item).into_array_of_tables() {
        Ok(tables) => Item::ArrayOfTables(tables),
        Err(other) => other.into_table().map_or_else(std::convert::identity, Item::Table),
    };
}

/// Gives `[board]` a table for each segment and regulator, and the addresses their hexadecimal form.
fn unfold_board(document: &mut DocumentMut) {
    let Some(board) = document.get_mut("board").and_then(Item::as_table_mut) else { return };
    for (_, item) in board.iter_mut() {
        unfold(item);
    }
    let segments = board.get_mut("segment").and_then(Item::as_array_of_tables_mut);
    for segment in segments.into_iter().flat_map(|segments| segments.iter_mut()) {
        let address = segment.get_mut("imu").and_then(|imu| imu.get_mut("address"));
        if let Some(Item::Value(value)) = address
            && let Some(hexadecimal) =
                value.as_integer().and_then(|address| format!("{address:#04x}").parse::<Value>().ok())
        {
            *value = hexadecimal.decorated(" ", " ");
        }
    }
}

fn read<T: DeserializeOwned>(text: &str) -> Result<T, FileError> {
    toml_edit::de::from_str(text).map_err(|error| {
        let (line, column) = line_and_column(text, error.span().map_or(0, |span| span.start));
        let message = error.message().chars().take(200).collect::<String>().replace('\n', ", ");
        FileError::Syntax { line, column, message }
    })
}

/// The format number alone, so that the error for a file of another format is about its format, not its keys.
#[derive(Deserialize)]
struct Version {
    format: u32,
}
