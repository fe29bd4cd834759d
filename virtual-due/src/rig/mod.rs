//! The reference rig on the Due's pins: the simulated arm with its bend sensors, IMUs and pressure regulators.
//!
//! | what | where |
//! |---|---|
//! | bend sensors 1a, 1b, 2a, … 6b | A0 … A11: ADC channels 7 … 0, 10 … 13 |
//! | TCA9548A, address 0x70 | TWI1: D20 SDA (PB12), D21 SCL (PB13); its RESET on D22 (PB26) |
//! | IMU k, a BNO055 at 0x28 | channel k − 1 of the TCA9548A |
//! | regulators of module 1, right and left | D6 (PC24, PWML7), D7 (PC23, PWML6) |
//! | of module 2 | D8 (PC22, PWML5), D9 (PC21, PWML4) |
//! | of module 3 | D34 (PC2, PWML0), D36 (PC4, PWML1) |
//!
//! A regulator gives 280 kPa at full duty. Its pin counts as 0 or 1 where PIO drives it, and vents where nothing does. As
//! long as no regulator pin was ever given to the PWM or driven, the scenario's own program moves the arm, as a bench supply
//! would, so that a firmware that only senses sees a moving arm. From then on the pins alone count.

mod arm;
mod bno055;
mod faults;
mod sensors;
mod serial;
mod tca9548a;
mod wires;

use crate::model::{Cycles, I2c, Pin, Reception, World};
use arm::Arm;
pub use faults::{Faults, Held, ImuFault, MuxFault, Rail};
use rig_twin::{EndPose, REGULATORS, SEGMENTS, Scenario};
use sensors::Sensors;
use serial::Port;
use wires::{NoDevices, Wires};

/// The ADC channel of each bend sensor.
const BEND_CHANNELS: [u8; 12] = [7, 6, 5, 4, 3, 2, 1, 0, 10, 11, 12, 13];
/// PWM channel and line of PIOC of each regulator.
const REGULATOR_PINS: [(u8, u8); REGULATORS] = [(7, 24), (6, 23), (5, 22), (4, 21), (0, 2), (1, 4)];
/// UART and USART0 … USART3.
const PORTS: usize = 5;

const PIOB: u8 = 1;
const PIOC: u8 = 2;
const SDA: Pin = Pin { port: PIOB, line: 12 };
const SCL: Pin = Pin { port: PIOB, line: 13 };
const MUX_RESET: Pin = Pin { port: PIOB, line: 26 };

/// The rig.
///
/// ```
/// use rig_twin::Scenario;
/// use virtual_due::model::{CYCLES_PER_SECOND, World};
/// use virtual_due::rig::{Rail, Rig};
///
/// let mut rig = Rig::new(Scenario::FreeSwing, 7);
/// rig.faults.bend[0] = Some(Rail::High);
/// assert_eq!(rig.adc_counts(7, CYCLES_PER_SECOND), 4095);
/// ```
#[derive(Debug, Clone)]
pub struct Rig {
    /// What is broken.
    pub faults: Faults,
    now: Cycles,
    arm: Arm,
    sensors: Sensors,
    wires: Wires,
    ports: [Port; PORTS],
    no_devices: NoDevices,
    scans: u64,
    truth_at_scan: [EndPose; SEGMENTS],
}

impl Rig {
    /// The rig at rest at time 0, in a session of `seed`.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        let arm = Arm::new(scenario, seed);
        let sensors = Sensors::new(arm.twin().imu_quaternions());
        let truth_at_scan = arm.twin().truth();
        Self {
            faults: Faults::default(),
            now: 0,
            arm,
            sensors,
            wires: Wires::default(),
            ports: std::array::from_fn(|_| Port::default()),
            no_devices: NoDevices,
            scans: 0,
            truth_at_scan,
        }
    }

    /// Lets the arm move up to `now`. The world's calls do so by themselves; who looks at the truth while the firmware sleeps
    /// asks for it.
    pub fn advance_to(&mut self, now: Cycles) {
        self.now = self.now.max(now);
        self.arm.advance_to(now);
        self.sensors.follow(&self.faults, self.now);
    }

    /// True world pose of each segment's end, at the last 2 ms before the latest time that the rig knows.
    pub fn truth(&self) -> [EndPose; SEGMENTS] {
        self.arm.twin().truth()
    }

    /// How often bend sensor 1a was converted, and the truth at the last time: what a sample's estimate is to be held
    /// against.
    pub fn last_scan(&self) -> (u64, [EndPose; SEGMENTS]) {
        (self.scans, self.truth_at_scan)
    }

    /// What the regulators are commanded, Pa: module 1 right, left, module 2 right, left, module 3 right, left.
    pub fn set_points_pa(&self) -> [f64; REGULATORS] {
        self.arm.set_points_pa()
    }

    /// The simulated arm.
    pub fn twin(&self) -> &rig_twin::Rig {
        self.arm.twin()
    }

    /// IMU `imu`, counted from 0, falls back to its CONFIG mode without a word, as of the latest time that the rig knows.
    pub fn brown_out(&mut self, imu: usize) {
        self.sensors.brown_out(imu, self.now);
    }

    /// Bytes for the receiver of a serial port, 0 for UART and 1 … 4 for USART0 … USART3: one after the other, at its byte
    /// time, and none before a time.
    pub fn send(&mut self, port: usize, bytes: &[u8], not_before: Cycles) {
        self.ports[port].send(bytes, not_before);
    }

    /// What a serial port has sent since last asked, each byte with the end of its stop bit.
    pub fn take_transmitted(&mut self, port: usize) -> Vec<(Cycles, u8)> {
        self.ports[port].take_transmitted()
    }
}

impl World for Rig {
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        self.advance_to(now);
        let Some(sensor) = BEND_CHANNELS.iter().position(|wired| *wired == channel) else { return 0 };
        let counts = self.arm.convert(sensor);
        if sensor == 0 {
            self.scans += 1;
            self.truth_at_scan = self.truth();
        }
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
        if let Some(regulator) = REGULATOR_PINS.iter().position(|(wired, _)| *wired == channel) {
            self.arm.pulse(regulator, duty);
        }
    }

    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles) {
        self.advance_to(now);
        let regulator = REGULATOR_PINS.iter().position(|(_, line)| pin == Pin { port: PIOC, line: *line });
        match pin {
            SDA => self.drive_sda(level),
            SCL => self.drive_scl(level, now),
            MUX_RESET => self.drive_mux_reset(level),
            _ => {
                if let Some(regulator) = regulator {
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

#[cfg(test)]
mod tests;
