//! A TCA9548A, an I²C multiplexer (Texas Instruments SCPS207).

use super::faults::MuxFault;

/// The multiplexer.
#[derive(Debug, Clone, Default)]
pub struct Tca9548a {
    /// The control register: a bit for each channel.
    control: u8,
    /// The byte that is read back.
    read_back: u8,
    /// The connected channels: the register at the last stop condition (SCPS207 8.6.2).
    connected: u8,
    held_in_reset: bool,
}

impl Tca9548a {
    /// Its address, A2 to A0 low.
    pub const ADDRESS: u8 = 0x70;

    /// True if it acknowledges its address.
    pub fn answers(&self, fault: Option<MuxFault>) -> bool {
        !self.held_in_reset && fault != Some(MuxFault::Silent)
    }

    /// A byte written to it; of several the last counts.
    pub fn write(&mut self, byte: u8, fault: Option<MuxFault>) {
        let (control, read_back) = match fault {
            None => (byte, byte),
            Some(MuxFault::Wrong(channels)) => (byte.rotate_left(channels.into()), byte.rotate_left(channels.into())),
            Some(MuxFault::Lying(channels)) => (byte.rotate_left(channels.into()), byte),
            Some(MuxFault::Silent | MuxFault::Stuck) => return,
        };
        (self.control, self.read_back) = (control, read_back);
    }

    /// The control register as it is read back.
    pub fn read(&self) -> u8 {
        self.read_back
    }

    /// Handles a stop condition, which connects the channels in the register.
    pub fn stop(&mut self) {
        self.connected = self.control;
    }

    /// The channels that are connected to the bus, a bit each.
    pub fn connected(&self) -> u8 {
        self.connected
    }

    /// RESET, low active: no channel, as after power-on.
    pub fn set_reset(&mut self, low: bool) {
        self.held_in_reset = low;
        if low {
            (self.control, self.read_back, self.connected) = (0, 0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{MuxFault, Tca9548a};

    #[test]
    fn channel_is_connected_after_the_stop_condition() {
        let mut mux = Tca9548a::default();
        mux.write(0x04, None);
        assert_eq!((mux.connected(), mux.read()), (0, 0x04));
        mux.stop();
        assert_eq!(mux.connected(), 0x04);
    }

    #[test]
    fn reset_disconnects_all_and_it_does_not_answer() {
        let mut mux = Tca9548a::default();
        mux.write(0xFF, None);
        mux.stop();
        mux.set_reset(true);
        assert_eq!((mux.connected(), mux.answers(None)), (0, false));
        mux.set_reset(false);
        assert_eq!((mux.read(), mux.answers(None)), (0, true));
    }

    #[test]
    fn wrong_one_connects_another_channel_and_a_lying_one_denies_it() {
        for (fault, read_back) in [(MuxFault::Wrong(1), 0b1000), (MuxFault::Lying(1), 0b100)] {
            let mut mux = Tca9548a::default();
            mux.write(0b100, Some(fault));
            mux.stop();
            assert_eq!((mux.connected(), mux.read()), (0b1000, read_back));
        }
    }

    #[test]
    fn stuck_one_acknowledges_and_stays_where_it_was() {
        let mut mux = Tca9548a::default();
        mux.write(1, None);
        mux.stop();
        mux.write(2, Some(MuxFault::Stuck));
        mux.stop();
        assert_eq!((mux.connected(), mux.read(), mux.answers(Some(MuxFault::Stuck))), (1, 1, true));
    }
}
