//! A seed, and the files that seeds are made from.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Name and bytes of a seed.
pub type Seed = (String, Vec<u8>);

/// Names and paths of the repository's tables and arm descriptions.
pub const TABLES: [(&str, &str); 5] = [
    ("planar-6", "calibration-tables/planar-6.toml"),
    ("description", "calibration-tables/arms/planar-6.toml"),
    ("version-0.1", "host-tests/tables/version-0.1.toml"),
    ("version-0.1-anchor", "host-tests/tables/version-0.1-anchor.toml"),
    ("trunk-planar", "host-tests/tables/trunk-planar.toml"),
];

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
