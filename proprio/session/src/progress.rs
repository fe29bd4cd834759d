//! Progress of long work, reported to whoever started it.

/// Receives the progress of long work.
pub trait Progress {
    /// Of `work`, this number of parts of all is done; called once for every row.
    fn advance(&mut self, work: &str, done_of_all: (u64, u64));

    /// The same of parts that take long each; `work` may differ from call to call.
    fn complete(&mut self, work: &str, done_of_all: (u64, u64));
}

/// Discards the progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&mut self, _: &str, _: (u64, u64)) {}

    fn complete(&mut self, _: &str, _: (u64, u64)) {}
}
