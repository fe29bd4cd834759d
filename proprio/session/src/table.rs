//! A table with the path of its file, which errors name.

use std::path::Path;

use calibration_tables::{ArmFile, CompiledTable, FileError};
use estimator_core::FusedOps;

use crate::Error;
use crate::recording::attached_table;
use crate::required_columns::RequiredColumns;
use crate::source::{FileFormat, SessionFile};

/// A table and the path of its file.
#[derive(Debug, Clone)]
pub struct LoadedTable<'p> {
    /// The table.
    pub file: ArmFile,
    /// Path of its file.
    pub path: &'p Path,
}

/// The table that is attached to a recording; `None` of another session, and without one.
///
/// # Errors
/// [`SessionError`](crate::SessionError) where the file cannot be opened.
pub fn recorded_table(path: &Path) -> Result<Option<ArmFile>, Error> {
    let file = SessionFile::open(path)?;
    if file.kind != FileFormat::Recording || !file.is_regular_file {
        return Ok(None);
    }
    Ok(attached_table(file.into_bytes()?))
}

impl<'p> LoadedTable<'p> {
    /// Reads and checks an arm description or table.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn load(path: &'p Path) -> Result<Self, Error> {
        let file = ArmFile::load(path).map_err(|source| Error::Table { path: path.to_owned(), source })?;
        Ok(Self { file, path })
    }

    /// The text of the file.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn toml(&self) -> Result<Vec<u8>, Error> {
        std::fs::read(self.path).map_err(|source| self.error(source.into()))
    }

    /// The columns that it requires of a session.
    ///
    /// # Errors
    /// [`Error::Table`] on an arm description.
    pub fn required_columns(&self) -> Result<RequiredColumns, Error> {
        RequiredColumns::of_table(&self.file).map_err(|source| self.error(source))
    }

    /// The estimator's parameters for one sample rate.
    ///
    /// # Errors
    /// [`Error::Table`] on an arm description.
    pub fn compile<S: FusedOps>(&self, rate_hz: f64) -> Result<CompiledTable<S>, Error> {
        self.file.compile(rate_hz).map_err(|source| self.error(source))
    }

    /// True where the bias filter corrects the drift.
    #[must_use]
    pub fn has_bias_filter(&self) -> bool {
        self.file.bias_filter().is_some()
    }

    fn error(&self, source: FileError) -> Error {
        Error::Table { path: self.path.to_owned(), source }
    }
}
