//! Ctrl-C during long work: what Python's handler raises ends the work.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

use proprio_session::Progress;
use pyo3::prelude::*;

/// Time between two checks: each takes Python's lock.
const PERIOD: Duration = Duration::from_millis(50);

/// Checks for an interrupt whenever the work reports its progress. The work has no way back for a progress that ends it, so that an
/// interrupt unwinds it, as a panic does, without a message.
pub struct Interruptible {
    checked: Instant,
}

impl Interruptible {
    fn check(&mut self) {
        if self.checked.elapsed() < PERIOD {
            return;
        }
        self.checked = Instant::now();
        if let Some(raised) = Python::attach(|py| py.check_signals().err()) {
            resume_unwind(Box::new(raised));
        }
    }
}

impl Progress for Interruptible {
    fn advance(&mut self, _: &str, _: (u64, u64)) {
        self.check();
    }

    fn complete(&mut self, _: &str, _: (u64, u64)) {
        self.check();
    }
}

/// Does long work without Python's lock.
///
/// # Errors
/// What Python's handler of an interrupt raises: `KeyboardInterrupt`.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&mut Interruptible) -> T + Send) -> PyResult<T> {
    let done = py.detach(|| {
        let mut progress = Interruptible { checked: Instant::now() };
        catch_unwind(AssertUnwindSafe(|| work(&mut progress)))
    });
    done.map_err(|panic| panic.downcast::<PyErr>().map_or_else(|panic| resume_unwind(panic), |raised| *raised))
}
