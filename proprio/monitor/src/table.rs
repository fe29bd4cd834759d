//! The table of a monitor: a file that was given, or the board's own.

use std::io::Write;
use std::path::PathBuf;

use calibration_tables::ArmFile;
use proprio_session::LoadedTable;
use tempfile::TempPath;

use crate::error::Error;

/// A table and its file.
#[derive(Debug)]
pub(super) struct OwnedTable {
    pub file: ArmFile,
    path: PathBuf,
    /// The file of a board's table is removed with it.
    _copy: Option<TempPath>,
}

impl OwnedTable {
    /// A table that was given.
    pub fn given(table: &LoadedTable) -> Self {
        Self { file: table.file.clone(), path: table.path.to_owned(), _copy: None }
    }

    /// A table as a board stores it; `None` for an arm description, with which there is no estimate.
    pub fn of_board(toml: &str) -> Result<Option<Self>, Error> {
        let path = PathBuf::from("the board's table");
        let failed = |source| proprio_session::Error::Output { path: path.clone(), source };
        let mut copy = tempfile::Builder::new().suffix(".toml").tempfile().map_err(failed)?;
        copy.write_all(toml.as_bytes()).map_err(failed)?;
        let copy = copy.into_temp_path();
        let file = LoadedTable::load(&copy)?.file;
        Ok((!file.is_description()).then(|| Self { file, path: copy.to_path_buf(), _copy: Some(copy) }))
    }

    pub fn loaded(&self) -> LoadedTable<'_> {
        LoadedTable { file: self.file.clone(), path: &self.path }
    }
}
