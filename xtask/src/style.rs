//! `cargo xtask style`: idiom words, comment lines that begin with a question word, circles of files, sizes.

use crate::tool::cargo;

/// Shows the counts and every place; it fails where one is above its limit.
pub fn run() -> Result<(), String> {
    cargo(
        &["test", "--quiet", "--package", "host-tests", "--test", "style", "--", "--nocapture", "--test-threads", "1"],
        &[],
    )
}
