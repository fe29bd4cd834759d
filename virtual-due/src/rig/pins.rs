//! The rig as the chip's world: ADC channels, PWM, GPIOs, serial ports, and the I²C bus of TWI1.

use super::WiredRig;
use super::faults::{HeldLow, Rail};
use board_table::Wiring;
use sam3x_models::model::{Cycles, I2c, Pin, Reception, World};

/// The ADC channel of each analog pin, A0 to A11.
const ANALOG_CHANNELS: [u8; 12] = [7, 6, 5, 4, 3, 2, 1, 0, 10, 11, 12, 13];
/// Digital pins of the regulators, each with its PWM channel and its line of PIOC.
const PWM_PINS: [(u8, u8, u8); 8] =
    [(6, 7, 24), (7, 6, 23), (8, 5, 22), (9, 4, 21), (34, 0, 2), (36, 1, 4), (38, 2, 6), (40, 3, 8)];
const PIOB: u8 = 1;
pub const PIOC: u8 = 2;
pub const SDA: Pin = Pin { port: PIOB, line: 12 };
pub const SCL: Pin = Pin { port: PIOB, line: 13 };
pub const MUX_RESET: Pin = Pin { port: PIOB, line: 26 };

/// Channels and lines of the wired pins.
#[derive(Debug, Clone)]
pub struct Pins {
    /// ADC channel of each bend sensor, in the order 1a, 1b, 2a, …
    bend_channels: Vec<Option<u8>>,
    /// The ADC channel whose conversion counts as that of a scan: the first bend sensor's, or A0's.
    pub scan_channel: u8,
    /// PWM channel and line of PIOC of each regulator.
    regulators: Vec<Option<(u8, u8)>>,
}

impl Pins {
    /// The pins of a wiring. A pin that the board does not have is not wired.
    pub fn new(wiring: &Wiring) -> Self {
        let channel = |pin: u8| ANALOG_CHANNELS.get(usize::from(pin)).copied();
        let pins = wiring.segments.iter().flat_map(|segment| segment.bend);
        let bend_channels: Vec<Option<u8>> = pins.map(|pin| pin.and_then(channel)).collect();
        let scan_channel = bend_channels.iter().flatten().next().copied().unwrap_or(ANALOG_CHANNELS[0]);
        let output =
            |wired: u8| PWM_PINS.iter().find(|(pin, ..)| *pin == wired).map(|(_, channel, line)| (*channel, *line));
        let regulators = wiring.regulators.iter().map(|regulator| output(regulator.pin)).collect();
        Self { bend_channels, scan_channel, regulators }
    }

    /// The bend sensor on an ADC channel.
    fn sensor(&self, channel: u8) -> Option<usize> {
        self.bend_channels.iter().position(|wired| *wired == Some(channel))
    }

    /// The regulator on a PWM channel.
    fn pulsed(&self, channel: u8) -> Option<usize> {
        self.regulators.iter().position(|wired| wired.is_some_and(|(wired, _)| wired == channel))
    }

    /// The regulator on a line.
    fn driven(&self, pin: Pin) -> Option<usize> {
        self.regulators.iter().position(|wired| wired.is_some_and(|(_, line)| pin == Pin { port: PIOC, line }))
    }
}

impl World for WiredRig {
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        self.advance_to(now);
        if channel == self.pins.scan_channel {
            self.scans += 1;
            self.truth_at_scan = self.truth();
        }
        let Some(sensor) = self.pins.sensor(channel) else { return 0 };
        let Some(counts) = self.arm.convert(sensor) else { return 0 };
        match self.faults.bend[sensor] {
            None => counts,
            Some(Rail::Low) => 0,
            Some(Rail::High) => 4095,
        }
    }

    fn i2c(&mut self, twi: usize) -> &mut dyn I2c {
        if twi == 1 { self } else { &mut self.no_devices }
    }

    fn pwm(&mut self, channel: u8, duty: Option<(u32, u32)>, now: Cycles) {
        self.advance_to(now);
        if let Some(regulator) = self.pins.pulsed(channel) {
            self.arm.pulse(regulator, duty);
        }
    }

    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles) {
        self.advance_to(now);
        match pin {
            SDA => self.drive_sda(level),
            SCL => self.drive_scl(level, now),
            MUX_RESET => self.drive_mux_reset(level),
            _ => {
                if let Some(regulator) = self.pins.driven(pin) {
                    self.arm.drive(regulator, level);
                }
            }
        }
    }

    /// Pull-ups hold the wires and RESET high.
    fn level(&mut self, pin: Pin, _now: Cycles) -> Option<bool> {
        match pin {
            SDA => Some(self.faults.sda.is_none()),
            SCL => Some(self.faults.scl.is_none()),
            MUX_RESET => Some(true),
            _ => None,
        }
    }

    fn transmitted(&mut self, port: usize, byte: u8, now: Cycles) {
        self.ports[port].note_transmitted(byte, now);
    }

    fn receive(&mut self, port: usize, byte_time: Cycles, now: Cycles) -> Reception {
        self.ports[port].receive(byte_time, now)
    }
}

impl I2c for WiredRig {
    fn start(&mut self, address: u8, read: bool, now: Cycles) -> bool {
        self.advance_to(now);
        let orientations = self.arm.twin().imu_quaternions();
        self.sensors.start(address, read, now, &orientations, &self.faults)
    }

    fn write(&mut self, byte: u8, now: Cycles) -> bool {
        self.advance_to(now);
        self.sensors.write(byte, now, &self.faults)
    }

    fn read(&mut self, now: Cycles) -> u8 {
        self.advance_to(now);
        if self.faults.sda.is_some() { 0 } else { self.sensors.read() }
    }

    fn stop(&mut self, now: Cycles) {
        self.advance_to(now);
        self.sensors.stop();
    }

    fn stretch(&mut self, _now: Cycles) -> Cycles {
        self.sensors.stretch()
    }

    fn held(&mut self, _now: Cycles) -> (bool, bool) {
        (self.faults.scl.is_some(), self.faults.sda.is_some())
    }

    /// Counts a clock pulse for a line that is held low for a number of them.
    fn pulse(&mut self, _now: Cycles) {
        self.faults.sda = self.faults.sda.and_then(HeldLow::clocked);
        self.faults.scl = self.faults.scl.and_then(HeldLow::clocked);
    }
}

impl WiredRig {
    /// Drives SDA; a rise while SCL is high is a stop condition.
    fn drive_sda(&mut self, level: Option<bool>) {
        let high = level.unwrap_or(true);
        if high && !self.wires.sda && self.wires.scl && self.faults.sda.is_none() {
            self.sensors.stop();
        }
        self.wires.sda = high;
    }

    /// Drives SCL; each rise is a clock pulse.
    fn drive_scl(&mut self, level: Option<bool>, now: Cycles) {
        let high = level.unwrap_or(true);
        if high && !self.wires.scl {
            self.pulse(now);
        }
        self.wires.scl = high;
    }

    /// Drives RESET; low disconnects all channels and ends the faults that it can end.
    fn drive_mux_reset(&mut self, level: Option<bool>) {
        let low = level == Some(false);
        self.sensors.mux.set_reset(low);
        if low {
            self.faults.mux = None;
            self.faults.sda = self.faults.sda.filter(|held| *held != HeldLow::UntilMuxReset);
            self.faults.scl = self.faults.scl.filter(|held| *held != HeldLow::UntilMuxReset);
        }
    }
}
