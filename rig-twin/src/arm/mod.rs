//! Parameters of one arm: its tolerances, the same in every session.

mod drawn;
mod parameters;
mod reference;

pub(crate) use parameters::{
    ActuatorParameters, ArmParameters, CurveParameters, ImuParameters, PairParameters, RegulatorParameters,
    StripParameters,
};

impl ArmParameters {
    /// The arm of a seed; 0 is the reference arm.
    pub(crate) fn new(arm_seed: u64) -> Self {
        if arm_seed == 0 { reference::arm() } else { drawn::arm(arm_seed) }
    }
}
