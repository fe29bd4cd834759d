//! The board's pins as they are observed from outside: jumper wires between them, and a record of their changes.

use sam3x_models::model::{Cycles, I2c, Pin, Reception, World};
use std::collections::BTreeMap;

/// A change of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PinChange {
    /// Board time.
    pub at: Cycles,
    /// The pin.
    pub pin: Pin,
    /// Its level; `None`: nothing drives it.
    pub level: Option<bool>,
}

/// Jumper wires, and the levels of watched pins.
#[derive(Debug, Default)]
pub struct Pins {
    /// Two pins each.
    pub wires: Vec<[Pin; 2]>,
    /// Levels of pins that a wire drives from its other end.
    pub wired: BTreeMap<Pin, bool>,
    /// Levels of pins that peripherals drive.
    pub outputs: BTreeMap<Pin, bool>,
    /// Changes since they were last taken, if they are recorded.
    pub changes: Option<Vec<PinChange>>,
}

impl Pins {
    /// True if outputs of peripherals have to be followed edge by edge.
    pub fn are_watched(&self) -> bool {
        self.changes.is_some() || !self.wires.is_empty()
    }

    /// Records a change.
    pub fn record(&mut self, pin: Pin, level: Option<bool>, at: Cycles) {
        if let Some(changes) = &mut self.changes {
            changes.push(PinChange { at, pin, level });
        }
    }
}

/// The world as models see it: with the wires between its pins.
pub struct WiredWorld<'a, W> {
    /// The devices on the pins.
    pub world: &'a mut W,
    /// The wires, and the record.
    pub pins: &'a mut Pins,
}

impl<W: World> World for WiredWorld<'_, W> {
    fn adc_tag(&mut self, channel: u8) -> u8 {
        self.world.adc_tag(channel)
    }

    fn adc_is_stopped(&mut self) -> bool {
        self.world.adc_is_stopped()
    }

    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        self.world.adc_counts(channel, now)
    }

    fn i2c(&mut self, twi: usize) -> &mut dyn I2c {
        self.world.i2c(twi)
    }

    fn pwm(&mut self, channel: u8, duty: Option<(u32, u32)>, now: Cycles) {
        self.world.pwm(channel, duty, now);
    }

    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles) {
        self.pins.record(pin, level, now);
        self.world.drive(pin, level, now);
    }

    fn level(&mut self, pin: Pin, now: Cycles) -> Option<bool> {
        self.pins.wired.get(&pin).copied().or_else(|| self.world.level(pin, now))
    }

    fn transmitted(&mut self, port: usize, byte: u8, now: Cycles) {
        self.world.transmitted(port, byte, now);
    }

    fn receive(&mut self, port: usize, byte_time: Cycles, now: Cycles) -> Reception {
        self.world.receive(port, byte_time, now)
    }
}
