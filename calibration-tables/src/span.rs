//! Line and column of bytes and keys in a file's text, for error messages.

use toml_edit::{Document, Item};

/// Line and column, from 1, of a byte of `text`.
pub(crate) fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |end| end + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// Line of a key such as `segment[2].bend[1].c0`, counted from 1 as in the key; that of the innermost part in the file.
pub(crate) fn line_of(text: &str, key: &str) -> Option<usize> {
    let document = Document::parse(text).ok()?;
    let mut item: &Item = document.as_item();
    let mut byte = None;
    for part in key.split(['.', '[']) {
        let inner = match part.strip_suffix(']').and_then(|index| index.parse::<usize>().ok()) {
            Some(index) => item.get(index.checked_sub(1)?),
            None => item.get(part),
        };
        let Some(inner) = inner else { break };
        item = inner;
        byte = item.span().map(|span| span.start).or(byte);
    }
    byte.map(|byte| line_and_column(text, byte).0)
}
