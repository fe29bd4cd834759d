//! Check that a board without a host, and one that has restarted, vents the arm and moves nothing by itself.

use virtual_due::{CYCLES_PER_SECOND, Cycles};

use super::finding::{Finding, Invariant};
use crate::board::Board;

/// Time after which the arm is vented: 1.5 s.
const VENTED: Cycles = CYCLES_PER_SECOND * 3 / 2;
/// Time for which the host is silent after a restart: 2 s.
const AFTER_RESTART: Cycles = 2 * CYCLES_PER_SECOND;
/// Time for which the host is silent after it was gone for longer than [`VENTED`]: 1 s.
const AFTER_RETURN: Cycles = CYCLES_PER_SECOND;

/// From when on the arm has to be vented.
#[derive(Default)]
pub struct Venting {
    vented_from: Option<Cycles>,
    silent_until: Cycles,
    is_cut: bool,
}

impl Venting {
    /// The host is gone.
    pub fn gone(&mut self, now: Cycles) {
        self.is_cut = true;
        self.vent(now);
    }

    /// The host is back.
    pub fn back(&mut self, now: Cycles) {
        self.is_cut = false;
        match self.vented_from {
            Some(from) if now >= from => self.silent_until = self.silent_until.max(now + AFTER_RETURN),
            _ => self.vented_from = None,
        }
    }

    /// The board has restarted.
    pub fn restarted(&mut self, at: Cycles) {
        self.silent_until = at + AFTER_RESTART;
        self.vented_from = Some(at + VENTED);
    }

    /// The host vents.
    pub fn vent(&mut self, now: Cycles) {
        self.vented_from = Some(self.vented_from.map_or(now + VENTED, |from| from.min(now + VENTED)));
    }

    /// The host has asked for pressures to move.
    pub fn armed(&mut self) {
        if !self.is_cut {
            self.vented_from = None;
        }
    }

    /// True while the host sends nothing, to check that nothing moves.
    pub const fn is_silent(&self, now: Cycles) -> bool {
        now < self.silent_until
    }

    /// Checks the regulators.
    pub fn check(&self, board: &Board) -> Option<Finding> {
        let from = self.vented_from?;
        if board.machine.now() < from || board.is_vented() {
            return None;
        }
        let pressures_pa = board.machine.world().set_points_pa();
        let highest_kpa = pressures_pa.iter().copied().fold(0.0, f64::max) / 1e3;
        let figure = format!("{highest_kpa:.1} kPa where it has to be vented");
        Some(Finding { size: highest_kpa, ..Finding::new(Invariant::Vented, board.machine.seconds(), figure) })
    }
}
