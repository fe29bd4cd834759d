//! Tables and arm descriptions: checked text, and its values as JSON.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, PLANAR_6_ARM, PLANAR_6_TABLE};
use proprio_session::{Error, LoadedTable};
use pyo3::prelude::*;

use crate::error::exception;

/// Text of a table, and the path that errors name.
#[derive(FromPyObject)]
pub struct TableText {
    #[pyo3(attribute("_text"))]
    text: String,
    #[pyo3(attribute("path"))]
    path: PathBuf,
}

impl TableText {
    /// The table.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn load(&self) -> Result<LoadedTable<'_>, Error> {
        parse(&self.text, &self.path)
    }
}

fn parse<'p>(text: &str, path: &'p Path) -> Result<LoadedTable<'p>, Error> {
    let file = ArmFile::parse(text).map_err(|source| Error::Table { path: path.to_owned(), source })?;
    Ok(LoadedTable { file, path })
}

/// Reads and checks a table or an arm description; returns its text and its values as JSON.
#[pyfunction]
pub fn load_table(py: Python<'_>, path: PathBuf) -> PyResult<(String, String)> {
    let load = || {
        let table = LoadedTable::load(&path)?;
        // What was checked above is text.
        Ok::<_, Error>((String::from_utf8_lossy(&table.toml()?).into_owned(), json(&table.file)))
    };
    load().map_err(|error| exception(py, error))
}

/// Checks the text of a table or an arm description; returns its values as JSON.
#[pyfunction]
pub fn parse_table(py: Python<'_>, text: &str, path: PathBuf) -> PyResult<String> {
    parse(text, &path).map(|table| json(&table.file)).map_err(|error| exception(py, error))
}

/// The reference arm's table.
#[pyfunction]
pub fn reference_table() -> &'static str {
    PLANAR_6_TABLE
}

/// The reference arm's description.
#[pyfunction]
pub fn reference_arm() -> &'static str {
    PLANAR_6_ARM
}

fn json(file: &ArmFile) -> String {
    serde_json::to_string(file).expect("every value of the format has a form in JSON")
}
