//! Defects of a session's file, past which it is read.

use crate::recording::HoleTimes;

/// Defects of a file, past which it is read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileDefects {
    /// The last line has no line end: its last number may be cut.
    pub last_line_is_open: bool,
    /// The damaged parts of a recording, which are left out, by the times of the rows.
    pub holes: Vec<HoleTimes>,
}

impl FileDefects {
    /// A warning about each of them.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let last_line =
            self.last_line_is_open.then(|| "the last line has no end; its last number may be cut".to_owned());
        self.holes.iter().map(HoleTimes::to_string).chain(last_line)
    }
}
