//! Ctrl-C and termination: the program ends at once, except in work that can end early with a result.

use std::sync::atomic::{AtomicBool, Ordering};

use proprio_session::discard_unfinished;

/// Exit status after Ctrl-C or a termination, as shells have it.
const INTERRUPTED: i32 = 130;

static IS_GUARDED: AtomicBool = AtomicBool::new(false);
static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// Handles interrupts from now on.
pub fn install() {
    // Without a handler an interrupt leaves a temporary file; nothing else depends on it.
    let _ = ctrlc::set_handler(|| {
        // The second request ends the program at once.
        if !IS_GUARDED.load(Ordering::SeqCst) || IS_REQUESTED.swap(true, Ordering::SeqCst) {
            end();
        }
    });
}

/// Ends the program as an interrupt does.
pub fn end() -> ! {
    discard_unfinished();
    std::process::exit(INTERRUPTED);
}

/// Guard of work that can end early: while it lives, the first interrupt requests its owner to end, and a second one ends the
/// program.
#[derive(Debug)]
pub struct ShutdownGuard(());

impl ShutdownGuard {
    /// Guards from now on.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "it changes the state of the program")]
    pub fn new() -> Self {
        IS_REQUESTED.store(false, Ordering::SeqCst);
        IS_GUARDED.store(true, Ordering::SeqCst);
        Self(())
    }

    /// True after an interrupt.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        IS_REQUESTED.load(Ordering::SeqCst)
    }
}

impl Drop for ShutdownGuard {
    fn drop(&mut self) {
        IS_GUARDED.store(false, Ordering::SeqCst);
    }
}
