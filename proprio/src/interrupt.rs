//! Ctrl-C and termination: a command that runs until it is told to stop ends well, every other one at once.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::output::discard_unfinished;

/// Exit status after Ctrl-C or a termination, as shells have it.
const INTERRUPTED: i32 = 130;

/// A command ends by itself when it is asked to.
static AWAITED: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Handles interrupts from now on.
pub fn install() {
    // Without a handler an interrupt leaves an unfinished file behind, and nothing worse.
    let _ = ctrlc::set_handler(|| {
        // Who asks twice does not want to wait.
        if !AWAITED.load(Ordering::SeqCst) || ASKED.swap(true, Ordering::SeqCst) {
            discard_unfinished();
            std::process::exit(INTERRUPTED);
        }
    });
}

/// This command ends by itself, when [`is_asked`] says so.
pub fn wait_for() {
    AWAITED.store(true, Ordering::SeqCst);
}

/// Whether the command shall end.
#[must_use]
pub fn is_asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}
