//! Waveform mode (datasheet 36.6.9 to 36.6.14): the counter's events at RA, RB, RC and its ends.

use super::channel::{CPAS, CPBS, CPCS, Channel, ETRGS};
use super::mode::Waveform;
use crate::model::Cycles;

impl Channel {
    /// The counter has just reached its value. Where RA and RC are the same, RC decides (datasheet 36.6.13).
    pub(super) fn meet_in_waveform_mode(&mut self, at: Cycles) {
        let value = self.counter_value();
        let turns_at_rc = self.mode.waveform() == Waveform::UpDownRc;
        if value == self.rc {
            self.meet_rc(at);
        } else {
            self.meet_ra_and_rb(value);
        }
        let top = if turns_at_rc { self.rc } else { u32::MAX };
        let at_end = if self.counts_down() { value == 0 } else { value == top };
        if self.mode.turns() && at_end {
            self.turn();
        }
    }

    fn meet_ra_and_rb(&mut self, value: u32) {
        if value == self.ra {
            self.status |= CPAS;
            self.set_tioa(self.mode.a_at_ra());
        }
        if value == self.rb {
            self.note_rb();
            self.set_tiob(self.mode.b_at_rb());
        }
    }

    fn meet_rc(&mut self, at: Cycles) {
        let begins_again = self.mode.waveform() == Waveform::UpRc;
        // In UP mode with RC the value RC is the next period's 0, which RA or RB may meet as well.
        let met = |register: u32, rc: u32| register == rc || (begins_again && register == 0);
        self.status |= CPCS;
        let a_at_ra = if met(self.ra, self.rc) {
            self.status |= CPAS;
            self.mode.a_at_ra()
        } else {
            0
        };
        let b_at_rb = if met(self.rb, self.rc) {
            self.note_rb();
            self.mode.b_at_rb()
        } else {
            0
        };
        let or = |first: u32, second: u32| if first == 0 { second } else { first };
        self.set_tioa(or(self.mode.a_at_rc(), a_at_ra));
        self.set_tiob(or(self.mode.b_at_rc(), b_at_rb));
        if begins_again {
            self.restart();
        }
        if self.mode.disables_at_rc() {
            self.disable_clock(at);
        } else if self.mode.stops_at_rc() {
            self.stop_clock(at);
        }
    }

    /// While TIOB is an input RB makes no waveform and no interrupt (datasheet 36.7.4, EEVT).
    fn note_rb(&mut self) {
        if !self.mode.tiob_is_input() {
            self.status |= CPBS;
        }
    }

    /// An edge of the external event, which EEVT selects.
    pub(super) fn external_event(&mut self, level: bool, at: Cycles) {
        if !self.mode.is_waveform() || !self.mode.event_edges().include(level) {
            return;
        }
        self.status |= ETRGS;
        self.set_tioa(self.mode.a_at_event());
        if self.mode.event_triggers() {
            self.trigger(at);
        }
    }
}
