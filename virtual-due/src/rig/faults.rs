//! What a test or a user may break.

use rig_twin::{BEND_SENSORS, SEGMENTS};

/// What is broken now.
#[derive(Debug, Clone, Default)]
pub struct Faults {
    /// Bend sensors 1a, 1b, … 6b.
    pub bend: [Option<Rail>; BEND_SENSORS],
    /// IMUs 1 … 6.
    pub imus: [ImuFault; SEGMENTS],
    /// The multiplexer.
    pub mux: Option<MuxFault>,
    /// Something holds SDA low.
    pub sda: Option<Held>,
    /// Something holds SCL low.
    pub scl: Option<Held>,
}

/// Where a broken bend sensor's input lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rail {
    /// 0 counts: the strip is shorted.
    Low,
    /// 4095 counts: the strip is open.
    High,
}

/// What is wrong with an IMU.
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

/// What is wrong with the multiplexer, until its RESET.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MuxFault {
    /// It does not answer; the channels stay as they are.
    Silent,
    /// It acknowledges, but its channels and its register stay as they are.
    Stuck,
}

/// How long a line is held low.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// Until the fault is taken away.
    Forever,
    /// For this many more clock pulses, given by hand with SCL as a GPIO.
    Clocks(u32),
    /// Until the multiplexer is reset, which disconnects the culprit.
    UntilMuxReset,
}

impl Held {
    /// After a clock pulse.
    pub(super) fn clocked(self) -> Option<Self> {
        match self {
            Self::Clocks(left) => left.checked_sub(1).filter(|left| *left > 0).map(Self::Clocks),
            other => Some(other),
        }
    }
}
