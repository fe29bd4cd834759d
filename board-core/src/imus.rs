//! The arm's IMUs behind the multiplexer: who is read in a tick, what comes of it, and who is in which state.
//!
//! A tick has two halves. [`Imus::read`] does all that needs the bus; its future may be dropped at any time, which is
//! how a caller bounds it. [`Imus::judge`] then gives the readings that can be trusted, and what has changed.
//!
//! # How long a tick can take
//!
//! An IMU that runs costs three transactions, and a fourth in every fourth tick: six take 2.2 to 2.4 ms on the wire at
//! 400 kHz, and 3.3 ms where all of them have to be checked. The others do not wait for one that is missing: after three
//! refusals it is asked only every 25 ticks (250 ms), and each time costs selecting its channel and one address. No tick
//! makes more than 36 transactions, nor clears the bus more than once.
//!
//! # Faults
//!
//! | what is seen | what is done | state |
//! |---|---|---|
//! | no acknowledge | asked again in the next tick, after three every 25 ticks | `Off` after three ticks |
//! | no unit quaternion | the reading is rejected, mode and status are checked | `Garbage` after three ticks |
//! | no fusion, wrong mode or identity | started anew; runs again after 5 to 76 ticks | `Off` at once, then `Ok` |
//! | the tick ended in an IMU's transaction | the bus is cleared; asked again after 25 ticks | `Slow` after three ticks |
//! | bus error, or a multiplexer that fails | [`BusRecovery`], multiplexer reset, the rest of the tick goes on | `Off` after three ticks |
//! | repeats itself while another turns | its readings are withheld until one differs | `Stuck` after 50 ticks |
//!
//! An IMU that was `Off` may have started anew, and then its heading does too: whoever uses headings aligns them again
//! after an [`Event::Imu`] with `Off`. A dip of the supply that the chip does not answer in takes up to 250 ms beyond its
//! own 650 ms until it is asked again, and 5 ticks to start: well under 2 s.

mod bus;
mod frozen;
mod unit;

use crate::bno055;
use crate::tca9548a::{Channel, Tca9548a};
use bus::Bus;
pub use bus::{BusRecovery, BusStuck};
use embedded_hal::digital::OutputPin;
use embedded_hal_async::i2c::I2c;
use heapless::Vec;
use telemetry::{Event, SEGMENTS, SensorHealth};
use unit::Unit;

/// Most events of a tick: each IMU's state, and one recovery of the bus.
pub const EVENTS: usize = SEGMENTS + 1;

/// What a tick brought.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Judged {
    /// Raw quaternion w, x, y, z of each IMU, in units of 2⁻¹⁴; `None`: not read, or not to be trusted.
    pub imu: [Option<[i16; 4]>; SEGMENTS],
    /// What has changed.
    pub events: Vec<Event, EVENTS>,
}

/// The IMUs of the arm, from the base: IMU k is on channel k of the multiplexer, both counted from 0.
///
/// ```
/// use board_core::imus::{BusRecovery, Imus};
/// use embedded_hal::digital::OutputPin;
/// use embedded_hal_async::i2c::I2c;
///
/// /// Once every 10 ms; in an application `read` stands in a time limit.
/// async fn tick<I: I2c + BusRecovery, R: OutputPin>(imus: &mut Imus<I, R>, tick: u32) -> [Option<[i16; 4]>; 6] {
///     imus.read(tick).await;
///     imus.judge().imu
/// }
/// ```
#[derive(Debug)]
pub struct Imus<I, R> {
    bus: Bus<I, R>,
    units: [Unit; SEGMENTS],
}

impl<I: I2c + BusRecovery, R: OutputPin> Imus<I, R> {
    /// All IMUs, at their default address, none read yet. Nothing is sent.
    pub fn new(i2c: I, mux: Tca9548a<R>) -> Self {
        Self { bus: Bus::new(i2c, mux), units: core::array::from_fn(|_| Unit::new(bno055::ADDRESS)) }
    }

    /// Reads each IMU that is due in tick number `tick`, once a tick. The future may be dropped at any await; what was
    /// read until then counts, and the next call clears the bus first.
    pub async fn read(&mut self, tick: u32) {
        let mut may_recover = true;
        for (k, (unit, channel)) in (0..).zip(self.units.iter_mut().zip(Channel::ALL)) {
            // From one IMU to the next the count is shifted, so that they are checked in different ticks.
            let tick = tick.wrapping_add(k);
            if !unit.is_due(tick) {
                continue;
            }
            if self.bus.is_in_doubt() {
                if !may_recover || !self.bus.recover().await {
                    return;
                }
                may_recover = false;
            }
            unit.read(&mut self.bus, channel, tick).await;
        }
    }

    /// Judges what the last [`read`](Self::read) brought; once a tick, also when that was cut off.
    pub fn judge(&mut self) -> Judged {
        let seen = self.units.each_ref().map(Unit::seen);
        let mut judged = Judged { imu: [None; SEGMENTS], events: Vec::new() };
        // There is room for an event of each IMU and one of the bus: no push can fail.
        if self.bus.take_cleared() {
            let _ = judged.events.push(Event::BusRecovery);
        }
        for (k, (unit, imu)) in (0..).zip(self.units.iter_mut().zip(&mut judged.imu)) {
            let before = unit.health().state;
            *imu = unit.judge(&seen);
            let state = unit.health().state;
            if state != before {
                let _ = judged.events.push(Event::Imu(k, state));
            }
        }
        judged
    }

    /// State of each IMU, and in how many ticks it gave no reading to be trusted.
    pub fn health(&self) -> [SensorHealth; SEGMENTS] {
        self.units.each_ref().map(Unit::health)
    }

    /// How often since boot the bus was found stuck and cleared; stays at its largest value.
    pub fn bus_recoveries(&self) -> u32 {
        self.bus.recoveries()
    }
}
