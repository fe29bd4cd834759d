//! Faults of the rig that tests and users inject.

use rig_twin::MAX_SEGMENTS;

/// The present faults.
#[derive(Debug, Clone, Default)]
pub struct Faults {
    /// Bend sensors 1a, 1b, 2a, …; those that the arm does not have stay without effect.
    pub bend: [Option<Rail>; 2 * MAX_SEGMENTS],
    /// IMUs of segments 1, 2, …; those that the arm does not have stay without effect.
    pub imus: [ImuFault; MAX_SEGMENTS],
    /// The multiplexer.
    pub mux: Option<MuxFault>,
    /// Something holds SDA low.
    pub sda: Option<HeldLow>,
    /// Something holds SCL low.
    pub scl: Option<HeldLow>,
}

/// Level of a broken bend sensor's input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rail {
    /// 0 counts: the strip is shorted.
    Low,
    /// 4095 counts: the strip is open.
    High,
}

/// Fault of an IMU.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ImuFault {
    /// Nothing.
    #[default]
    None,
    /// It has no power and does not answer. When this ends it boots.
    Unplugged,
    /// Its data never change.
    Frozen,
}

/// Fault of the multiplexer, until its RESET.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MuxFault {
    /// It does not answer; the channels stay as they are.
    Silent,
    /// It acknowledges, but its channels and its register stay as they are.
    Stuck,
}

/// Duration for which a line is held low.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldLow {
    /// Until the fault is removed.
    UntilRemoved,
    /// For this many more clock pulses, generated with SCL as a GPIO.
    Clocks(u32),
    /// Until the multiplexer is reset, which disconnects the culprit.
    UntilMuxReset,
}

impl HeldLow {
    /// The rest of the duration after a clock pulse.
    pub(super) fn clocked(self) -> Option<Self> {
        match self {
            Self::Clocks(left) => left.checked_sub(1).filter(|left| *left > 0).map(Self::Clocks),
            other => Some(other),
        }
    }
}
