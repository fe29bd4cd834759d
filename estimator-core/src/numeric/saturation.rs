//! Counts the operations of [`Q`](crate::Q) whose result did not fit and was saturated.
//!
//! The count is global, as an operator has no context of its own. A saturation means that a table or a reading is out of
//! the range of the format.

use core::sync::atomic::{AtomicU32, Ordering};

static SATURATIONS: AtomicU32 = AtomicU32::new(0);

/// Number of saturated operations since the program began.
#[must_use]
pub fn saturations() -> u32 {
    SATURATIONS.load(Ordering::Relaxed)
}

#[cold]
pub(crate) fn count() {
    SATURATIONS.fetch_add(1, Ordering::Relaxed);
}
