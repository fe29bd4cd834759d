//! The present faults of bus, multiplexer and converter; those of sensors are in the simulated arm.

use rig_twin::{Fault, Hold};

/// The present faults.
#[derive(Debug, Clone, Default)]
pub(super) struct Faults {
    pub mux: Option<MuxFault>,
    /// Something holds SDA low.
    pub sda: Option<Hold>,
    /// Something holds SCL low.
    pub scl: Option<Hold>,
    pub adc: Option<AdcFault>,
    /// The last channel that was converted, and whether that was in an odd scan.
    converted: (u8, bool),
}

/// Fault of the multiplexer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MuxFault {
    /// It does not answer; the channels stay as they are. Its RESET ends it.
    Silent,
    /// It acknowledges, but its channels and its register stay as they are. Its RESET ends it.
    Stuck,
    /// It connects a channel that is so many further on, and reads back what it has connected.
    Wrong(u8),
    /// It connects a channel that is so many further on, and reads back the one requested.
    Lying(u8),
}

/// Fault of the converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AdcFault {
    /// It ignores its triggers.
    Stopped,
    /// Every conversion has the tag of the next channel.
    Tags,
    /// The same in every second scan.
    TagsEveryOther,
}

impl Faults {
    /// Counts scans: a scan converts its channels in rising order, unless a firmware gives an order of its own.
    pub fn note_conversion(&mut self, channel: u8) {
        let (last, is_odd) = self.converted;
        self.converted = (channel, is_odd ^ (channel <= last));
    }

    /// True in every second scan.
    pub fn is_odd_scan(&self) -> bool {
        self.converted.1
    }

    /// Sets or ends a fault; false if it is another device's.
    pub fn set(&mut self, fault: Fault, is_present: bool) -> bool {
        match fault {
            Fault::SdaHeld(hold) => self.sda = is_present.then_some(hold),
            Fault::SclHeld(hold) => self.scl = is_present.then_some(hold),
            Fault::MuxSilent => self.mux = is_present.then_some(MuxFault::Silent),
            Fault::MuxStuck => self.mux = is_present.then_some(MuxFault::Stuck),
            Fault::MuxWrong(channels) => self.mux = is_present.then_some(MuxFault::Wrong(channels)),
            Fault::MuxLying(channels) => self.mux = is_present.then_some(MuxFault::Lying(channels)),
            Fault::AdcStopped => self.adc = is_present.then_some(AdcFault::Stopped),
            Fault::AdcTags => self.adc = is_present.then_some(AdcFault::Tags),
            Fault::AdcTagsEveryOther => self.adc = is_present.then_some(AdcFault::TagsEveryOther),
            _ => return false,
        }
        true
    }
}

/// The rest of the time for which a line is held low, after a clock pulse.
pub(super) fn clocked(hold: Hold) -> Option<Hold> {
    match hold {
        Hold::Clocks(left) => left.checked_sub(1).filter(|left| *left > 0).map(Hold::Clocks),
        other => Some(other),
    }
}
