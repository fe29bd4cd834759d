//! Configuration of a session: arm, scenario, motion, and the session's seed.

use crate::layout::Layout;
use crate::motion::Motion;
use crate::noise::Seeds;
use crate::scenario::Scenario;

/// Configuration of a session.
///
/// The same setup results in the same session, to the bit.
///
/// ```
/// use rig_twin::{MotionProgram, Rig, Scenario, Setup};
///
/// let setup = Setup { arm_seed: 5, ..Setup::new(Scenario::Push, 7) };
/// let (mut rig, program) = (Rig::of(&setup), MotionProgram::of(&setup));
/// rig.step(0.01, &program.duties(rig.time_s()));
/// assert_ne!(rig.truth(), Rig::new(Scenario::Push, 7).truth(), "arm 5 is not the reference arm");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Seed of the arm's tolerances, the same in all of its sessions; 0 is the reference arm.
    pub arm_seed: u64,
    /// Segments of the arm, their lengths and sensors.
    pub layout: Layout,
    /// Contacts of the arm, and the amplitude of its swings.
    pub scenario: Scenario,
    /// Motion of the arm.
    pub motion: Motion,
    /// Seed of the session's motion, contacts, power-up headings, turn-on biases, temperature, stored creep and noise.
    /// Two arms share no random numbers in sessions of one seed.
    pub seed: u64,
}

impl Setup {
    /// The session of `seed` on the reference arm, which swings.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        Self { arm_seed: 0, layout: Layout::default(), scenario, motion: Motion::Swings, seed }
    }

    pub(crate) const fn seeds(&self) -> Seeds {
        Seeds { arm: self.arm_seed, session: self.seed }
    }
}
