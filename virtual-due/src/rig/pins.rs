//! The rig as the chip's world: ADC channels, PWM, GPIOs, serial ports, and the I²C bus of TWI1.

use super::WiredRig;
use super::faults::{AdcFault, MuxFault, clocked};
use rig_twin::Hold;
use sam3x_models::model::{Cycles, I2c, Pin, Reception, World};

const PIOB: u8 = 1;
pub const SDA: Pin = Pin { port: PIOB, line: 12 };
pub const SCL: Pin = Pin { port: PIOB, line: 13 };
pub const MUX_RESET: Pin = Pin { port: PIOB, line: 26 };

impl World for WiredRig {
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        self.advance_to(now);
        self.faults.note_conversion(channel);
        if channel == self.pins.scan_channel {
            self.scans += 1;
            self.truth_at_scan = self.truth();
        }
        let Some(sensor) = self.pins.sensor(channel) else { return 0 };
        self.arm.convert(sensor).unwrap_or(0)
    }

    fn adc_tag(&mut self, channel: u8) -> u8 {
        let is_wrong = match self.faults.adc {
            Some(AdcFault::Tags) => true,
            Some(AdcFault::TagsEveryOther) => self.faults.is_odd_scan(),
            Some(AdcFault::Stopped) | None => false,
        };
        if is_wrong { (channel + 1) % 16 } else { channel }
    }

    fn adc_is_stopped(&mut self) -> bool {
        self.faults.adc == Some(AdcFault::Stopped)
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
        self.sensors.start(address, read, now, &orientations, self.faults.mux)
    }

    fn write(&mut self, byte: u8, now: Cycles) -> bool {
        self.advance_to(now);
        self.sensors.write(byte, now, self.faults.mux)
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
        self.faults.sda = self.faults.sda.and_then(clocked);
        self.faults.scl = self.faults.scl.and_then(clocked);
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
            self.faults.mux = self.faults.mux.filter(|fault| matches!(fault, MuxFault::Wrong(_) | MuxFault::Lying(_)));
            self.faults.sda = self.faults.sda.filter(|held| *held != Hold::UntilMuxReset);
            self.faults.scl = self.faults.scl.filter(|held| *held != Hold::UntilMuxReset);
        }
    }
}
