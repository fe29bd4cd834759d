//! Detection of a board's restarts in its stream.

/// Ticks that a stream may go back without a restart, 1 s: a piece of it may arrive twice.
const REPEATED: u32 = 100;

/// Detects restarts of a board: by the boot number in its `Hello`, and by ticks that go back, as boots are numbered from 1
/// again after a power cut.
#[derive(Debug, Default)]
pub struct BootTracker {
    boot: Option<u32>,
    tick: Option<u32>,
    /// The line was opened since the last sample: the next one is no repetition.
    is_opened: bool,
}

/// Relation of a sample to those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuity {
    /// After the others.
    Next,
    /// Received before.
    Duplicate,
    /// After a restart of the board.
    Restarted,
}

impl BootTracker {
    /// Notes that the line was opened (again).
    pub fn opened(&mut self) {
        self.is_opened = true;
    }

    /// Takes the boot number of a `Hello`; returns true where the board has restarted.
    pub fn hello(&mut self, boot: u32) -> bool {
        let restarted = self.boot.is_some_and(|before| before != boot);
        if restarted {
            self.tick = None;
        }
        self.boot = Some(boot);
        restarted
    }

    /// Takes the tick of a sample.
    pub fn sample(&mut self, tick: u32) -> Continuity {
        let may_repeat = !std::mem::take(&mut self.is_opened);
        let continuity = match self.tick {
            Some(last) if may_repeat && tick <= last && last - tick < REPEATED => return Continuity::Duplicate,
            Some(last) if tick <= last => Continuity::Restarted,
            _ => Continuity::Next,
        };
        if continuity == Continuity::Restarted {
            // The next `Hello` is of this run, with any boot number.
            self.boot = None;
        }
        self.tick = Some(tick);
        continuity
    }
}
