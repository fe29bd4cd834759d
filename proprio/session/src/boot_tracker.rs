//! One run of a board after the other.

/// Ticks that a stream may go back without a restart, 1 s: a piece of it may come twice.
const REPEATED: u32 = 100;

/// Tells the runs of a board apart: by the number of the boot in its `Hello`, and by ticks that begin anew, as after a
/// power cut boots are numbered from 1 again.
#[derive(Debug, Default)]
pub struct BootTracker {
    boot: Option<u32>,
    tick: Option<u32>,
    /// The line was opened since the last sample: what comes now has not come before.
    is_opened: bool,
}

/// Where a sample stands in the stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuity {
    /// Behind the others.
    Next,
    /// It has come already.
    Duplicate,
    /// In another run.
    Restarted,
}

impl BootTracker {
    /// The line is opened (again).
    pub fn opened(&mut self) {
        self.is_opened = true;
    }

    /// Takes a `Hello`'s boot; says whether it is of another run.
    pub fn hello(&mut self, boot: u32) -> bool {
        let restarted = self.boot.is_some_and(|before| before != boot);
        if restarted {
            self.tick = None;
        }
        self.boot = Some(boot);
        restarted
    }

    /// Takes a sample's tick.
    pub fn sample(&mut self, tick: u32) -> Continuity {
        let may_repeat = !std::mem::take(&mut self.is_opened);
        let place = match self.tick {
            Some(last) if may_repeat && tick <= last && last - tick < REPEATED => return Continuity::Duplicate,
            Some(last) if tick <= last => Continuity::Restarted,
            _ => Continuity::Next,
        };
        if place == Continuity::Restarted {
            // The next `Hello`, whatever its boot, is of this run.
            self.boot = None;
        }
        self.tick = Some(tick);
        place
    }
}
