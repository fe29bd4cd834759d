//! The program `proprio`, as the console script runs it.

use std::ffi::OsString;
use std::path::PathBuf;

use proprio_link::set_program_folder;
use pyo3::prelude::*;

/// Runs the program with these arguments, the first of which is its name, and returns its exit status. Its files are in
/// `folder`.
#[pyfunction]
pub fn run(py: Python<'_>, arguments: Vec<OsString>, folder: PathBuf) -> u8 {
    set_program_folder(folder);
    py.detach(|| proprio::run(arguments))
}
