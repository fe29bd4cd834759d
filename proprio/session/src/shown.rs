//! A file's own text in messages.

/// Most characters that are shown.
const MOST: usize = 40;

/// A text of a file as it can be shown: one line without control characters, not too long.
pub(crate) fn shown(text: &str) -> String {
    text.trim().escape_debug().take(MOST).collect()
}
