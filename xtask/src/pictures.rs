//! `cargo xtask pictures`: makes the pictures of the documents from simulated sessions, in headless Chromium.

use std::fs;

use crate::board::{ANY_RUST, add_target};
use crate::tool::{cargo, root, target};

const PICTURES: [&str; 4] = ["live-page.png", "arm.png", "sweep.png", "report.png"];

/// Runs the browser tests that make the pictures, and copies these to `docs/pictures`. The variable `CHROMIUM` names another
/// browser than `chromium`.
pub fn run() -> Result<(), String> {
    add_target()?;
    cargo(&["build", ANY_RUST, "--package", "virtual-due", "--package", "proprio"], &[])?;
    let test =
        ["test", ANY_RUST, "--package", "board-tests", "--test", "browser", "--", "--ignored", "--test-threads", "1"];
    cargo(&[&test[..], &["pictures_of_the_documents"]].concat(), &[])?;
    for picture in PICTURES {
        let (from, to) = (target().join("browser").join(picture), root().join("docs/pictures").join(picture));
        fs::copy(&from, &to).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
    }
    Ok(())
}
