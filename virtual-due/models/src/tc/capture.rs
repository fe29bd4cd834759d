//! Capture mode (datasheet 36.6.8): edges of TIOA load the counter into RA and RB.

use super::channel::{Channel, ETRGS, LDRAS, LDRBS, LOVRS};
use crate::model::Cycles;

impl Channel {
    /// The outside moves TIOA. In waveform mode TIOA is an output.
    pub fn drive_tioa(&mut self, level: bool, at: Cycles) {
        if self.mode.is_waveform() || level == self.tioa {
            return;
        }
        self.tioa = level;
        self.load(level, at);
        if self.mode.trigger_is_tioa() {
            self.external_trigger(level, at);
        }
    }

    /// The outside moves TIOB.
    pub fn drive_tiob(&mut self, level: bool, at: Cycles) {
        let is_output = self.mode.is_waveform() && !self.mode.tiob_is_input();
        if is_output || level == self.tiob {
            return;
        }
        self.tiob = level;
        if self.mode.is_waveform() {
            self.external_event(level, at);
        } else if !self.mode.trigger_is_tioa() {
            self.external_trigger(level, at);
        }
    }

    fn external_trigger(&mut self, level: bool, at: Cycles) {
        if self.mode.trigger_edges().include(level) {
            self.status |= ETRGS;
            self.trigger(at);
        }
    }

    /// RA is loaded once after a trigger or a load of RB, RB once after a load of RA.
    fn load(&mut self, level: bool, at: Cycles) {
        if !self.ra_loaded && self.mode.load_a_edges().include(level) {
            self.ra = self.counter(at);
            self.ra_loaded = true;
            self.note_load(0, LDRAS);
        } else if self.ra_loaded && self.mode.load_b_edges().include(level) {
            self.rb = self.counter(at);
            self.ra_loaded = false;
            self.note_load(1, LDRBS);
            if self.mode.disables_at_rb_load() {
                self.disable_clock(at);
            } else if self.mode.stops_at_rb_load() {
                self.stop_clock(at);
            }
        }
    }

    fn note_load(&mut self, register: usize, bit: u32) {
        if self.unread[register] {
            self.status |= LOVRS;
        }
        self.unread[register] = true;
        self.status |= bit;
    }
}
