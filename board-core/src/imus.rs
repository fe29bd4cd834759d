//! The arm's IMUs behind the multiplexer: polling, validation of the readings, and the state of each IMU.
//!
//! A tick has two halves. [`Imus::read`] makes all transactions; its future may be dropped at any time, so that a caller
//! can bound its time. [`Imus::validate`] then returns the valid readings and the changes of state.
//!
//! # How long a tick can take
//!
//! An IMU that runs costs four transactions: six take 3.0 ms on the wire at 400 kHz. A missing IMU does not delay the others: after three NACKs it is
//! polled only every 25 ticks (250 ms), and each poll costs the selection of its channel and one address. Eight
//! take a third more. A tick has at most six transactions for each IMU and one recovery of the bus.
//!
//! # Faults
//!
//! | fault | reaction | state |
//! |---|---|---|
//! | no acknowledge | polled again in the next tick, after three every 25 ticks | `NoResponse` after three ticks |
//! | no unit quaternion | the reading is rejected | `Invalid` after three ticks |
//! | another IMU than the one that was started: a multiplexer that confirms a wrong channel | readings are rejected until it is the right one | `Invalid` after three ticks |
//! | no fusion, or wrong mode | restarted; runs again after 6 to 77 ticks | `NoResponse` at once, then `Ok` |
//! | the tick ended in an IMU's transaction | the bus is recovered; polled again after 25 ticks | `Timeout` after three ticks |
//! | bus error, or a multiplexer that fails | [`BusRecovery`], multiplexer reset, then the rest of the tick | `NoResponse` after three ticks |
//! | the same reading while another IMU turns | readings are rejected until one differs | `Stuck` after 50 ticks |
//! | the same readings as another IMU, while they change | those of both are rejected until they differ | `Invalid` after 5 changes |
//! | more than one reading in twenty is missing | those that are read pass | `Intermittent` |
//! | readings that the estimator finds implausible | they pass: it leaves them out until it has the new zero | `Inconsistent` |
//!
//! An IMU that was `NoResponse` may have restarted, and its heading with it: a user of headings aligns them again after
//! an [`Event::Imu`] with `NoResponse`. After a supply dip the chip does not answer for 650 ms; it is polled at most 250 ms
//! later and takes 6 ticks to start: well under 2 s.

mod bus;
mod channel;
mod copies;
mod stuck;

use crate::bend_sensors::NOT_WIRED;
use crate::tca9548a::Tca9548a;
use board_table::Wiring;
use bus::Bus;
pub use bus::{BusRecovery, BusStuck};
use channel::ImuChannel;
use copies::CopyDetector;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::i2c::I2c;
use heapless::Vec;
use telemetry::{Event, MAX_SEGMENTS, SensorHealth, vector};

/// Most events of a tick: each IMU's state, and one recovery of the bus.
pub const EVENTS: usize = MAX_SEGMENTS + 1;

/// Valid readings and events of one tick.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImuReadings {
    /// Raw quaternion w, x, y, z of each segment's IMU, in units of 2⁻¹⁴; `None`: not read, not valid, or no IMU there.
    pub imu: Vec<Option<[i16; 4]>, MAX_SEGMENTS>,
    /// Changes of state.
    pub events: Vec<Event, EVENTS>,
}

impl ImuReadings {
    /// Returns whether every IMU of the arm was read.
    pub fn all_are_read(&self, health: &[SensorHealth]) -> bool {
        self.imu.iter().zip(health).all(|(imu, health)| imu.is_some() || *health == NOT_WIRED)
    }
}

/// The IMUs of the arm, from the base, each on its channel of the multiplexer and at its address.
///
/// ```
/// use board_core::imus::{BusRecovery, ImuReadings, Imus};
/// use embedded_hal::digital::OutputPin;
/// use embedded_hal_async::i2c::I2c;
///
/// /// Called every 10 ms; an application bounds the time of `read`.
/// async fn tick<I: I2c + BusRecovery, R: OutputPin>(imus: &mut Imus<I, R>, tick: u32) -> ImuReadings {
///     imus.read(tick).await;
///     imus.validate()
/// }
/// ```
#[derive(Debug)]
pub struct Imus<I, R> {
    bus: Bus<I, R>,
    /// Each segment's; `None`: it has none.
    channels: Vec<Option<ImuChannel>, MAX_SEGMENTS>,
    copies: CopyDetector,
}

impl<I: I2c + BusRecovery, R: OutputPin> Imus<I, R> {
    /// The IMUs that are wired, not read yet. Makes no transaction.
    pub fn new(i2c: I, mux: Tca9548a<R>, wiring: &Wiring) -> Self {
        let segments = wiring.segments.iter().zip(1..);
        let channels = segments.map(|(segment, mark)| segment.imu.and_then(|place| ImuChannel::new(place, mark)));
        Self { bus: Bus::new(i2c, mux), channels: vector(channels), copies: CopyDetector::new() }
    }

    /// Reads each IMU that is due in tick number `tick`, once a tick. The future may be dropped at any await; readings
    /// until then count, and the next call recovers the bus first.
    pub async fn read(&mut self, tick: u32) {
        let mut may_recover = true;
        for (k, imu) in (0..).zip(&mut self.channels) {
            let Some(imu) = imu else { continue };
            // The tick is shifted by one for each IMU, so that they are checked in different ticks.
            let tick = tick.wrapping_add(k);
            if !imu.is_due(tick) {
                continue;
            }
            if self.bus.needs_recovery() {
                if !may_recover || !self.bus.recover().await {
                    return;
                }
                may_recover = false;
            }
            imu.read(&mut self.bus, tick).await;
        }
    }

    /// Takes the estimator's verdict on the readings of this tick: bit i of `implausible` is set if it leaves IMU i out.
    /// Reports each change of an IMU's state.
    pub fn set_implausible(&mut self, implausible: u8, mut report: impl FnMut(Event)) {
        for (k, imu) in (0..).zip(&mut self.channels) {
            let Some(imu) = imu else { continue };
            let before = imu.health().state;
            imu.set_implausible(implausible >> k & 1 != 0);
            if imu.health().state != before {
                report(Event::Imu(k, imu.health().state));
            }
        }
    }

    /// Validates the readings of the last [`read`](Self::read); once a tick, also if that was cut off.
    pub fn validate(&mut self) -> ImuReadings {
        let mut quaternions = [None; MAX_SEGMENTS];
        for (quaternion, imu) in quaternions.iter_mut().zip(&self.channels) {
            *quaternion = imu.as_ref().and_then(ImuChannel::quaternion);
        }
        let mut events = Vec::new();
        // There is room for an event of each IMU and one of the bus: no push can fail.
        if self.bus.take_recovery() {
            let _ = events.push(Event::BusRecovery);
        }
        let copies = self.copies.update(&quaternions);
        let imus = self.channels.iter_mut().zip(copies).zip(0..);
        let readings = imus.map(|((imu, is_copy), k)| {
            let imu = imu.as_mut()?;
            let before = imu.health().state;
            let valid = imu.validate(&quaternions, is_copy);
            let state = imu.health().state;
            if state != before {
                let _ = events.push(Event::Imu(k, state));
            }
            valid
        });
        let imu = vector(readings);
        ImuReadings { imu, events }
    }

    /// State of each IMU, and its ticks without a valid reading.
    pub fn health(&self) -> Vec<SensorHealth, MAX_SEGMENTS> {
        vector(self.channels.iter().map(|imu| imu.as_ref().map_or(NOT_WIRED, ImuChannel::health)))
    }

    /// Recoveries of a stuck bus since boot; saturates.
    pub fn bus_recoveries(&self) -> u32 {
        self.bus.recoveries()
    }
}
