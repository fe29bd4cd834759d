//! Progress of long work, reported to its caller.

/// Receives the progress of long work.
pub trait Progress {
    /// Reports the parts of `work` that are done, and all; called once for every row.
    fn advance(&mut self, work: &str, done_of_all: (u64, u64));

    /// The same for parts that take long each; `work` may differ from call to call.
    fn complete(&mut self, work: &str, done_of_all: (u64, u64));
}

/// Discards the progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&mut self, _: &str, _: (u64, u64)) {}

    fn complete(&mut self, _: &str, _: (u64, u64)) {}
}
