//! Copies of files, and empty folders.

use std::fs;
use std::path::{Path, PathBuf};

/// Copies a file into a folder and returns its new path.
pub fn copy(from: &Path, folder: &Path) -> Result<PathBuf, String> {
    let to = folder.join(from.file_name().unwrap_or_default());
    fs::copy(from, &to).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
    Ok(to)
}

/// An empty folder of this path.
pub fn emptied(path: &Path) -> Result<(), String> {
    let is_missing = !path.exists();
    let removed = if is_missing { Ok(()) } else { fs::remove_dir_all(path) };
    removed.and_then(|()| fs::create_dir_all(path)).map_err(|error| format!("{}: {error}", path.display()))
}
