//! A seed, and the files that seeds are made from.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Name and bytes of a seed.
pub type Seed = (String, Vec<u8>);

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A text of the repository.
pub fn text_of(path: &str) -> Result<String, Box<dyn Error>> {
    fs::read_to_string(root().join(path)).map_err(|error| format!("{path}: {error}").into())
}

/// A seed of a first byte and what follows it.
pub fn seed(name: impl Into<String>, first: u8, rest: &[u8]) -> Seed {
    (name.into(), [&[first], rest].concat())
}
