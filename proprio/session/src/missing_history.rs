//! Recordings that begin while the board runs, without the stream since its last tare.

use std::fmt;

use crate::Row;

/// Rows before which samples since the board's last tare are not in the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MissingHistory {
    /// Number of these rows.
    pub without: u64,
    /// Number of all rows.
    pub rows: u64,
}

impl MissingHistory {
    /// Adds a row of the recording.
    pub fn add(&mut self, row: &Row) {
        self.rows += 1;
        self.without += u64::from(!row.is_comparable());
    }

    /// True where there is such a row.
    #[must_use]
    pub const fn is_any(&self) -> bool {
        self.without > 0
    }
}

impl fmt::Display for MissingHistory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { without, rows } = self;
        write!(
            f,
            "samples since the board's last tare are not in the recording, so that {without} of its {rows} samples have another \
             tare or drift here than on the board"
        )
    }
}
