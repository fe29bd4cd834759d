//! Parameters of one arm: its tolerances, the same in every session.

mod drawn;
mod parameters;
mod reference;

pub(crate) use parameters::{
    ActuatorParameters, ArmParameters, CurveParameters, ImuParameters, PairParameters, RegulatorParameters,
    StripParameters,
};

use crate::layout::Layout;

impl ArmParameters {
    /// The arm of a seed with this layout; 0 has the reference arm's tolerances. Every device has a stream of its own,
    /// so that an arm with fewer devices differs from a longer one in nothing else.
    pub(crate) fn new(arm_seed: u64, layout: &Layout) -> Self {
        if arm_seed == 0 { reference::arm(layout) } else { drawn::arm(arm_seed, layout) }
    }
}
