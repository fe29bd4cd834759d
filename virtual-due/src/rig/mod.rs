//! The rig on the Due's pins: the simulated arm with its bend sensors, IMUs and pressure regulators.
//!
//! | what | where | in the reference wiring |
//! |---|---|---|
//! | bend sensors | A0 … A11: ADC channels 7 … 0, 10 … 13 | 1a, 1b, 2a, … 6b |
//! | TCA9548A, address 0x70 | TWI1: D20 SDA (PB12), D21 SCL (PB13); its RESET on D22 (PB26) | |
//! | IMUs, BNO055 units | its channels 0 … 7, at 0x28 or 0x29 | IMU k at 0x28 of channel k − 1 |
//! | regulators | D6 (PC24, PWML7), D7 (PC23, PWML6) | module 1, right and left |
//! | | D8 (PC22, PWML5), D9 (PC21, PWML4) | module 2 |
//! | | D34 (PC2, PWML0), D36 (PC4, PWML1) | module 3 |
//! | | D38 (PC6, PWML2), D40 (PC8, PWML3) | |
//!
//! A [`Wiring`] assigns the pins. An analog pin without a bend sensor is tied to GND, and reads 0. Regulator 1 of the wiring
//! bends module 1 to the right, regulator 2 to the left, and so on; a module without regulators stays vented, and regulators
//! beyond the arm's modules move nothing.
//!
//! A regulator gives its full scale at full duty, but no more than the 280 kPa of the supply. Its pin counts as 0 or 1 where PIO
//! drives it, and vents where nothing does. As long as no regulator pin was ever given to the PWM or driven, the scenario's own program moves the arm, as a bench supply
//! would, so that a firmware that only reads sensors has a moving arm. From then on the pins alone count.

mod arm;
mod bno055;
mod faults;
mod line;
mod pin_map;
mod pins;
mod sensors;
mod serial;
mod tca9548a;
mod wires;

use arm::DrivenArm;
use board_table::Wiring;
use faults::Faults;
use pin_map::Pins;
use rig_twin::{EndPose, Fault, FaultError, Layout, PerRegulator, PerSegment, Scenario, Setup, TimedFault};
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles};
use sensors::Sensors;
use serial::Port;
use wires::{NoDevices, Wires};

/// UART and USART0 … USART3.
const PORTS: usize = 5;
/// The UART.
const PROGRAMMING_PORT: usize = 0;

/// The rig.
///
/// ```
/// use rig_twin::Scenario;
/// use virtual_due::model::{CYCLES_PER_SECOND, World};
/// use virtual_due::rig::WiredRig;
///
/// let mut rig = WiredRig::new(Scenario::FreeSwing, 7);
/// rig.inject("bend1a:open".parse()?)?;
/// assert_eq!(rig.adc_counts(7, CYCLES_PER_SECOND), 4095);
/// # Ok::<(), rig_twin::FaultError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WiredRig {
    faults: Faults,
    now: Cycles,
    wiring: Wiring,
    pins: Pins,
    arm: DrivenArm,
    sensors: Sensors,
    wires: Wires,
    ports: [Port; PORTS],
    no_devices: NoDevices,
    scans: u64,
    truth_at_scan: PerSegment<EndPose>,
}

impl WiredRig {
    /// The reference arm in its reference wiring, at rest at time 0, in a session of `seed`.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        let setup = Setup::new(scenario, seed);
        Self::of(&setup, &Wiring::reference(setup.layout.segments().len()))
    }

    /// The arm of a session in this wiring, at time 0. A sensor has to be on the arm and wired.
    pub fn of(setup: &Setup, wiring: &Wiring) -> Self {
        let wiring = of_arm(wiring, &setup.layout);
        let arm = DrivenArm::new(setup, &wiring);
        let sensors = Sensors::new(&wiring, arm.twin().imu_quaternions(), setup.seed);
        let truth_at_scan = arm.twin().truth();
        Self {
            faults: Faults::default(),
            now: 0,
            pins: Pins::new(&wiring),
            wiring,
            arm,
            sensors,
            wires: Wires::default(),
            ports: std::array::from_fn(|_| Port::new(setup.seed)),
            no_devices: NoDevices,
            scans: 0,
            truth_at_scan,
        }
    }

    /// Advances the arm to `now`. Calls of [`World`](sam3x_models::model::World) do so, too; call it before you read the truth while the firmware sleeps.
    pub fn advance_to(&mut self, now: Cycles) {
        self.now = self.now.max(now);
        self.arm.advance_to(now);
    }

    /// True world pose of each segment's end, at the last multiple of 2 ms before the rig's time.
    pub fn truth(&self) -> PerSegment<EndPose> {
        self.arm.twin().truth()
    }

    /// Number of conversions of the first wired bend sensor (of A0 where there is none), and the truth at the last of them,
    /// with which a sample's estimate is compared.
    pub fn last_scan(&self) -> (u64, PerSegment<EndPose>) {
        (self.scans, self.truth_at_scan.clone())
    }

    /// Set-points of the wired regulators, Pa, in the wiring's order: module 1 right, left, module 2 right, left, …
    pub fn set_points_pa(&self) -> PerRegulator<f64> {
        self.arm.set_points_pa()
    }

    /// The simulated arm.
    pub fn twin(&self) -> &rig_twin::Rig {
        self.arm.twin()
    }

    /// Begins a fault of a sensor, the bus or the serial line of the programming port, at the rig's time.
    ///
    /// # Errors
    /// [`FaultError`] if the arm does not have the sensor, or the fault is one of the chip.
    pub fn inject(&mut self, fault: Fault) -> Result<(), FaultError> {
        self.check(fault)?;
        if fault.acts_on_readings() {
            let time_s = self.arm.twin().time_s();
            self.arm.twin_mut().inject(TimedFault::from(fault, time_s))?;
        }
        self.set(fault, true);
        Ok(())
    }

    /// Ends a fault, at the rig's time.
    pub fn clear(&mut self, fault: Fault) {
        self.arm.twin_mut().clear(fault);
        self.set(fault, false);
    }

    /// Checks that the rig can have a fault.
    ///
    /// # Errors
    /// [`FaultError::NotOnArm`].
    pub fn check(&self, fault: Fault) -> Result<(), FaultError> {
        let wired = |segment: usize| self.wiring.segments.get(segment);
        let has_bend = |index: usize| wired(index / 2).is_some_and(|segment| segment.bend[index % 2].is_some());
        let has_imu = |segment: usize| wired(segment).is_some_and(|segment| segment.imu.is_some());
        let is_there = fault.bend_sensor().is_none_or(has_bend) && fault.imu().is_none_or(has_imu);
        if is_there { Ok(()) } else { Err(FaultError::NotOnArm(fault.to_string())) }
    }

    /// Sets or ends a fault of the devices on the pins.
    fn set(&mut self, fault: Fault, is_present: bool) {
        if self.faults.set(fault, is_present) || self.ports[PROGRAMMING_PORT].faults.set(fault, is_present) {
            return;
        }
        let now = self.now;
        let Some(unit) = fault.imu().and_then(|segment| self.sensors.unit(segment)) else { return };
        match fault {
            Fault::ImuUnplugged(_) => {
                if !is_present && !unit.powered {
                    unit.imu.power_returns(now);
                }
                unit.powered = !is_present;
            }
            Fault::ImuReset(_) if is_present => unit.imu.power_on_reset(now),
            Fault::ImuBrownOut(_) if is_present => unit.imu.brown_out(now),
            Fault::ImuNack(_, share) => unit.nack_share = if is_present { share } else { 0.0 },
            Fault::ImuStretch(_, ms) => {
                unit.stretch = if is_present { (ms / 1e3 * CYCLES_PER_SECOND as f64) as Cycles } else { 0 };
            }
            _ => {}
        }
    }

    /// The supply of IMUs and multiplexer was cut, and returns at the rig's time.
    pub(crate) fn cut_power(&mut self) {
        self.sensors.cut_power(self.now);
    }

    /// The wiring, without the sensors that the arm does not have.
    pub fn wiring(&self) -> &Wiring {
        &self.wiring
    }

    /// Sends bytes to the receiver of a serial port, 0 for UART and 1 … 4 for USART0 … USART3: one after the other, at its
    /// byte time, from `not_before` on.
    pub fn send(&mut self, port: usize, bytes: &[u8], not_before: Cycles) {
        self.ports[port].send(bytes, not_before);
    }

    /// Takes the bytes that a serial port has sent since the last call, each with the end of its stop bit.
    pub fn take_transmitted(&mut self, port: usize) -> Vec<(Cycles, u8)> {
        self.ports[port].take_transmitted()
    }
}

/// A wiring without the sensors that the arm does not have.
fn of_arm(wiring: &Wiring, arm: &Layout) -> Wiring {
    let mut wiring = wiring.clone();
    wiring.segments.truncate(arm.segments().len());
    for (wired, segment) in wiring.segments.iter_mut().zip(arm.segments()) {
        for (pin, has_sensor) in wired.bend.iter_mut().zip(segment.bend) {
            *pin = pin.filter(|_| has_sensor);
        }
        wired.imu = wired.imu.filter(|_| segment.imu);
    }
    wiring
}

#[cfg(test)]
mod fault_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod wiring_tests;
