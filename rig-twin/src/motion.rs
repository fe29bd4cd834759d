//! Motions: changes, pace and interruptions of a scenario's swings.

use crate::constants::{
    FAST_PERIODS, LEAN_DRIVE, LEAN_PAUSE_LOG_S, LEAN_SPELL_S, LEAN_SWING_SHARE, PAUSE_BLEND_S, PAUSES, REST_DRIVE,
    REST_PAUSE_LOG_S, REST_SPELL_S, REST_VENTED_SHARE, SLOW_PERIODS,
};
use crate::layout::PerModule;
use crate::noise::Noise;
use crate::smooth_step::smooth_step;

/// Motion of the arm in a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Swings of all modules without a pause, after 5 s at rest.
    #[default]
    Swings,
    /// The same, twelve times as slow.
    Slow,
    /// The same, four times as fast.
    Fast,
    /// The same, of one module alone; the others stay where they are.
    OneModule,
    /// Spells of swings of 20 to 120 s between rests of two minutes to two hours, vented or bent.
    Rests,
    /// Spells of swings of 1 to 3 min between leans of 2 to 10 min, in which the arm hardly moves.
    Lean,
    /// Bent to one side from before the start, on the obstacle where there is one; swings after 5 s.
    BentStart,
    /// Swings from before the start.
    MovingStart,
}

impl Motion {
    /// Periods of the swings, a multiple of the scenario's.
    pub(crate) fn periods(self) -> f64 {
        match self {
            Self::Slow => SLOW_PERIODS,
            Self::Fast => FAST_PERIODS,
            _ => 1.0,
        }
    }

    /// Returns `true` if the session begins with the arm straight and at rest.
    pub(crate) fn starts_at_rest(self) -> bool {
        !matches!(self, Self::BentStart | Self::MovingStart)
    }
}

/// An interruption of the swings.
#[derive(Clone, Debug)]
struct Pause {
    start_s: f64,
    end_s: f64,
    /// Drive of each module meanwhile, a share of full pressure.
    pose: PerModule<f64>,
}

/// A round of interruptions, repeated without end.
#[derive(Clone, Debug)]
pub(crate) struct Pauses {
    round: Vec<Pause>,
    round_s: f64,
    swing_share: f64,
}

impl Pauses {
    /// Pauses of a motion of `modules` modules; `None` for most motions. `side` is the one to which the lower modules
    /// lean; 0: a random side.
    pub(crate) fn new(motion: Motion, modules: usize, side: f64, noise: &mut Noise) -> Option<Self> {
        let (spell_s, pause_log_s, swing_share) = match motion {
            Motion::Rests => (REST_SPELL_S, REST_PAUSE_LOG_S, 0.0),
            Motion::Lean => (LEAN_SPELL_S, LEAN_PAUSE_LOG_S, LEAN_SWING_SHARE),
            _ => return None,
        };
        let mut round_s = 0.0;
        let round = (0..PAUSES).map(|_| {
            let start_s = round_s + noise.between(spell_s);
            round_s = start_s + libm::exp(noise.between(pause_log_s));
            let vented = motion == Motion::Rests && noise.uniform() < REST_VENTED_SHARE;
            let range = if motion == Motion::Rests { REST_DRIVE } else { LEAN_DRIVE };
            let pose = if vented { still(modules) } else { leaning_pose(modules, range, side, noise) };
            Pause { start_s, end_s: round_s, pose }
        });
        Some(Self { round: round.collect(), round_s, swing_share })
    }

    /// Drives at `t_s` after the first rest; `swings` are the drives without a pause.
    pub(crate) fn interrupt(&self, t_s: f64, swings: PerModule<f64>) -> PerModule<f64> {
        let in_round_s = t_s % self.round_s;
        let next = self.round.partition_point(|pause| pause.end_s <= in_round_s);
        let Some(pause) = self.round.get(next) else { return swings };
        let begun = smooth_step((in_round_s - pause.start_s) / PAUSE_BLEND_S);
        let blend = begun * smooth_step((pause.end_s - in_round_s) / PAUSE_BLEND_S);
        let of_module = |(pose, swing): (&f64, f64)| {
            let paused = pose + self.swing_share * swing;
            swing + blend * (paused - swing)
        };
        pause.pose.iter().zip(swings).map(of_module).collect()
    }
}

/// Drives of modules that are vented.
pub(crate) fn still(modules: usize) -> PerModule<f64> {
    (0..modules).map(|_| 0.0).collect()
}

/// Drives of all modules at which the arm leans by a size within `range`: the lower ones to `side`, the last, or all
/// where `side` is 0, to a side each.
pub(crate) fn leaning_pose(modules: usize, range: (f64, f64), side: f64, noise: &mut Noise) -> PerModule<f64> {
    let of_module = |module| {
        let drawn = noise.sign();
        let free = side.abs() < 0.5 || module + 1 == modules;
        noise.between(range) * if free { drawn } else { side }
    };
    (0..modules).map(of_module).collect()
}
