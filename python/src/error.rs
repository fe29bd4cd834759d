//! Errors as the exception `proprio.Error`, with the text and the remedy of the program.

use proprio::Help;
use pyo3::prelude::*;

/// The exception for an error of the program.
pub fn exception(py: Python<'_>, error: impl Into<proprio::Error>) -> PyErr {
    let error = error.into();
    with_help(py, &error.to_string(), &error.help())
}

/// The exception for a text and its remedy.
pub fn with_help(py: Python<'_>, text: &str, help: &str) -> PyErr {
    let made = py.import("proprio._errors").and_then(|module| module.getattr("Error")?.call1((text, help)));
    made.map_or_else(|error| error, PyErr::from_value)
}
