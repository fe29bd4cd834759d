//! The true tip at each tick: by time, since a fault may take away scans, and a restart begins its ticks at 0.

use std::collections::VecDeque;

use virtual_due::{CYCLES_PER_SECOND, Cycles};

use crate::board::Board;

/// Time from one truth to the next, cycles: 2 ms.
pub const STEP: Cycles = CYCLES_PER_SECOND / 500;
/// Steps of a tick.
const STEPS_PER_TICK: u64 = 5;
/// Truths that are kept: 2 s.
const KEPT: usize = 1000;

/// The true tip in the last 2 s, and the step of tick 0.
#[derive(Default)]
pub struct TruthLog {
    tips_m: VecDeque<[f64; 2]>,
    /// Step of the newest.
    newest: u64,
    /// The straight arm's.
    straight_m: Option<[f64; 2]>,
    resets: usize,
    /// Step at whose end the scan of tick 0 was new; `None` before it.
    first: Option<u64>,
}

impl TruthLog {
    /// Adds the truth at the end of a step, in which there was a scan or not.
    pub fn add(&mut self, board: &mut Board, is_scan: bool) {
        let now = board.machine.now();
        board.machine.world_mut().advance_to(now);
        let step = now / STEP;
        let tip_m = board.machine.world().truth().last().map_or([f64::NAN; 2], |tip| [tip.x_m, tip.y_m]);
        self.straight_m.get_or_insert(tip_m);
        // A fault may take some steps at once.
        while self.newest < step {
            self.newest += 1;
            self.tips_m.push_back(tip_m);
        }
        while self.tips_m.len() > KEPT {
            self.tips_m.pop_front();
        }
        let resets = board.machine.resets().len();
        if resets != self.resets {
            (self.resets, self.first) = (resets, None);
        } else if is_scan && self.first.is_none() {
            self.first = Some(step);
        }
    }

    /// The true tip at the scan of a tick of this boot, m; `None` if it is not known any more.
    pub fn tip_m(&self, tick: u32) -> Option<[f64; 2]> {
        // The scan was in the step that ended at `first`: the truth before it.
        let step = self.first? + u64::from(tick) * STEPS_PER_TICK - 1;
        let age = usize::try_from(self.newest.checked_sub(step)?).ok()?;
        self.tips_m.len().checked_sub(1 + age).and_then(|index| self.tips_m.get(index)).copied()
    }

    /// Distance of the true tip from that of the straight arm at a tick, mm.
    pub fn offset_mm(&self, tick: u32) -> f64 {
        let tips = self.tip_m(tick).zip(self.straight_m);
        tips.map_or(f64::INFINITY, |(tip, straight)| 1e3 * (tip[0] - straight[0]).hypot(tip[1] - straight[1]))
    }
}
