//! Progress of long work, reported to whoever started it.

/// Receives the progress of long work.
pub trait Progress {
    /// `done` of `total` parts of `work` are done; called once for every row.
    fn advance(&mut self, work: &str, done: u64, total: u64);

    /// `done` of `total` parts are done, each of which takes long; `work` may differ from call to call.
    fn complete(&mut self, work: &str, done: u64, total: u64);
}

/// Discards the progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn advance(&mut self, _: &str, _: u64, _: u64) {}

    fn complete(&mut self, _: &str, _: u64, _: u64) {}
}
