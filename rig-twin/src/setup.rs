//! Configuration of a session: which arm, what touches it, how it moves, and the session's seed.

use crate::motion::Motion;
use crate::noise::Seeds;
use crate::program::Scenario;

/// Configuration of a session.
///
/// The same setup gives the same session, to the bit.
///
/// ```
/// use rig_twin::{Program, Rig, Scenario, Setup};
///
/// let setup = Setup { arm_seed: 5, ..Setup::new(Scenario::Two, 7) };
/// let (mut rig, program) = (Rig::of(&setup), Program::of(&setup));
/// rig.step(0.01, program.duties(rig.time_s()));
/// assert_ne!(rig.truth(), Rig::new(Scenario::Two, 7).truth(), "arm 5 is not the reference arm");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Seed of the arm's tolerances, the same in all of its sessions; 0 is the reference arm.
    pub arm_seed: u64,
    /// What touches the arm, and the size of its swings.
    pub scenario: Scenario,
    /// How the arm moves.
    pub motion: Motion,
    /// Seed of what differs between sessions: motion, contacts, power-up headings, turn-on biases,
    /// temperature, stored creep, noise. Two arms share no random numbers in sessions of one seed.
    pub seed: u64,
}

impl Setup {
    /// The session of `seed` on the reference arm, which swings.
    pub const fn new(scenario: Scenario, seed: u64) -> Self {
        Self { arm_seed: 0, scenario, motion: Motion::Swings, seed }
    }

    pub(crate) const fn seeds(&self) -> Seeds {
        Seeds { arm: self.arm_seed, session: self.seed }
    }
}
