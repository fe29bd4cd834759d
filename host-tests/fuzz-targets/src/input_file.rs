//! Inputs as files, which the readers of sessions open by their path.

use std::io::Write;
use std::path::Path;

use proprio_session::SessionError;

/// Calls `read` with the path of a file that holds these bytes, and whose name ends with `suffix`.
pub fn with_file<T>(suffix: &str, bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    let mut file = tempfile::Builder::new().suffix(suffix).tempfile().expect("there is room for a file");
    file.write_all(bytes).expect("there is room for a file");
    read(file.path())
}

/// Checks that an error is one line without control characters, and names a line that the text has.
pub fn check_error(error: &SessionError, text: &[u8]) {
    let message = error.to_string();
    assert!(!message.chars().any(char::is_control) && message.len() < 2000, "{message:?}");
    let lines = text.split(|byte| *byte == b'\n').count() as u64;
    assert!(error.line.is_none_or(|line| (1..=lines).contains(&line)), "{message} in {lines} lines");
}
