//! Ctrl-C and termination: the program ends at once, but for work that can end early and has something to show for it.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::output::discard_unfinished;

/// Exit status after Ctrl-C or a termination, as shells have it.
const INTERRUPTED: i32 = 130;

static IS_HEEDED: AtomicBool = AtomicBool::new(false);
static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// Handles interrupts from now on.
pub fn install() {
    // Without a handler an interrupt leaves an unfinished file behind, and nothing worse.
    let _ = ctrlc::set_handler(|| {
        // Who asks twice does not want to wait.
        if !IS_HEEDED.load(Ordering::SeqCst) || IS_REQUESTED.swap(true, Ordering::SeqCst) {
            end();
        }
    });
}

/// Ends the program as an interrupt does.
pub fn end() -> ! {
    discard_unfinished();
    std::process::exit(INTERRUPTED);
}

/// While this lives, the first interrupt asks its owner to come to an end, and only a second one ends the program.
#[derive(Debug)]
pub struct Heed(());

impl Heed {
    /// From now on interrupts are heeded.
    #[must_use]
    pub fn interrupts() -> Self {
        IS_REQUESTED.store(false, Ordering::SeqCst);
        IS_HEEDED.store(true, Ordering::SeqCst);
        Self(())
    }

    /// Whether there was one.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        IS_REQUESTED.load(Ordering::SeqCst)
    }
}

impl Drop for Heed {
    fn drop(&mut self) {
        IS_HEEDED.store(false, Ordering::SeqCst);
    }
}
