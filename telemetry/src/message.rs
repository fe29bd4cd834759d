//! Messages from the board.
//!
//! Units on the wire are SI: µs, rad, m, Pa. Angles and lengths are the bits of the estimator's fixed-point numbers, so that
//! nothing is lost.

use core::fmt;

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::bounded::Text;
use crate::conditions::Conditions;
use crate::constants::{MAX_BEND_SENSORS, MAX_REGULATORS, MAX_SEGMENTS};
use crate::request::{Reply, TareReport};
use crate::table_message::{TableChunk, TableState};
use crate::wire::{EstimateWire, SampleWire, UncertaintyWire};

/// A message from the board.
#[derive(Debug, Clone, PartialEq, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// Identity of the board and its boot; on request and once a second.
    Hello(Hello),
    /// Readings of all sensors in one tick.
    Sample(Sample),
    /// Shape of the arm, estimated from a sample.
    Estimate(Estimate),
    /// State of sensors and pressures, counters and timing.
    Health(Health),
    /// A change of state.
    Event(Event),
    /// Reply to a request.
    Reply(Reply),
    /// Covariance of an estimate, and contact.
    Uncertainty(Uncertainty),
    /// State of the table in the board's flash: after a start, after a ping, and after requests about the table.
    Table(TableState),
    /// A piece of the table, on request.
    TableData(TableChunk),
    /// Pose of the arm at a request to tare.
    Tare(TareReport),
}

/// Identity of the board and its firmware, and the cause of its boot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hello {
    /// Version of this protocol.
    pub protocol: u8,
    /// Hash of the messages' layout: [`SCHEMA`](crate::SCHEMA).
    pub schema: u32,
    /// Version of the firmware.
    pub firmware: Text<16>,
    /// Revision of the firmware's source.
    pub revision: Text<16>,
    /// Name of the arm that its table is for; empty without a table.
    pub arm: Text<32>,
    /// Checksum of its table; 0 without a table.
    pub table: u32,
    /// Segments of its arm.
    pub segments: u8,
    /// Bend sensors that are wired.
    pub bend_sensors: u8,
    /// Pressure regulators that are wired.
    pub regulators: u8,
    /// Unique number of its chip.
    pub chip: [u8; 16],
    /// Cause of the last reset.
    pub reset: ResetCause,
    /// Number of this boot since power-on.
    pub boot: u32,
    /// Message of the last panic or fault before this boot.
    pub last_panic: Option<Text<84>>,
}

/// Cause of a reset (datasheet, RSTC_SR).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// Power-on.
    PowerOn,
    /// Return from the backup mode.
    Backup,
    /// The watchdog.
    Watchdog,
    /// The firmware itself.
    Software,
    /// The reset pin: the button, or a host that opened the port.
    Pin,
}

/// Raw readings of one tick: everything that a replay needs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(into = "SampleWire", from = "SampleWire")]
pub struct Sample {
    /// Number of the tick since boot.
    pub tick: u32,
    /// Time of the tick since boot, µs; below 2⁴⁸.
    pub time_us: u64,
    /// Number of tares since boot, modulo 256. A change marks the first sample after the estimator's restart.
    pub tare_epoch: u8,
    /// Raw ADC counts, two places for each segment from the base, 1a, 1b, 2a, …; `None`: not read, or no sensor there.
    pub bend: Vec<Option<u16>, MAX_BEND_SENSORS>,
    /// Raw quaternion w, x, y, z of each segment's IMU, in units of 2⁻¹⁴; `None`: not read, or no IMU there.
    pub imu: Vec<Option<[i16; 4]>, MAX_SEGMENTS>,
}

/// The arm's shape by the Kalman filters, in the bits of `estimator_core::Q`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(into = "EstimateWire", from = "EstimateWire")]
pub struct Estimate {
    /// Number of the tick of its sample.
    pub tick: u32,
    /// The segments, from the base; `None`: not known yet.
    pub segments: Vec<Option<SegmentEstimate>, MAX_SEGMENTS>,
}

/// One segment's estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SegmentEstimate {
    /// Bend angle θ_i, rad, in units of 2⁻²⁶.
    pub theta: i32,
    /// World position x, y of the segment's end, m, in units of 2⁻²⁶.
    pub end: [i32; 2],
}

/// Covariance of an estimate and contact along the arm, in the bits of `estimator_core::Q`; variances are scaled by 64.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[serde(into = "UncertaintyWire", from = "UncertaintyWire")]
pub struct Uncertainty {
    /// Number of the tick of its estimate.
    pub tick: u32,
    /// The segments, from the base.
    pub segments: Vec<SegmentUncertainty, MAX_SEGMENTS>,
}

/// Variances of one segment's estimate, and its contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SegmentUncertainty {
    /// Variance of θ_i, rad², in units of 2⁻³²; `None`: not known.
    pub theta: Option<i32>,
    /// Covariance xx, xy, yy of the segment's end in {W}, m², in units of 2⁻³²; `None`: not known.
    pub end: Option<[i32; 3]>,
    /// Largest change of the residual within half a second, in percent of the free arm's limit; saturates at 255.
    pub contact_percent: u8,
    /// In contact: from more than 100 % on, until the change is reversed, or for a minute.
    pub in_contact: bool,
}

/// State of one sensor. JSON, diagnostics and `Display` have the names that version 0.1 gave the states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SensorState {
    /// Readings are valid.
    Ok,
    /// No response, or a reading at a rail.
    #[serde(rename = "Off")]
    NoResponse,
    /// The same reading again and again while other sensors move.
    Stuck,
    /// Readings outside of the sensor's range.
    #[serde(rename = "Garbage")]
    Invalid,
    /// Readings that contradict the other sensors: the estimator leaves them out.
    #[serde(rename = "Wrong")]
    Inconsistent,
    /// Readings after the deadline.
    #[serde(rename = "Slow")]
    Timeout,
    /// Readings with frequent gaps.
    Intermittent,
    /// The arm has no such sensor.
    NotWired,
}

impl SensorState {
    /// Returns whether readings of the sensor are used, though not each of them where it is intermittent.
    #[must_use]
    pub const fn is_usable(self) -> bool {
        matches!(self, Self::Ok | Self::Intermittent)
    }
}

impl SensorState {
    /// State of a sensor that is otherwise ok once the estimator has found its readings implausible, or plausible again.
    #[must_use]
    pub const fn judged(self, is_implausible: bool) -> Self {
        match self {
            Self::Ok | Self::Inconsistent if is_implausible => Self::Inconsistent,
            Self::Inconsistent => Self::Ok,
            other => other,
        }
    }
}

impl fmt::Display for SensorState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Ok => "Ok",
            Self::NoResponse => "Off",
            Self::Stuck => "Stuck",
            Self::Invalid => "Garbage",
            Self::Inconsistent => "Wrong",
            Self::Timeout => "Slow",
            Self::Intermittent => "Intermittent",
            Self::NotWired => "NotWired",
        })
    }
}

/// State of one sensor and its missed readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorHealth {
    /// State now.
    pub state: SensorState,
    /// Ticks without a valid reading since boot; saturates.
    pub missed: u16,
}

/// State of the pressures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Actuation {
    /// Vented, until it is armed.
    Disarmed,
    /// Follows set-points.
    Armed,
    /// The deadline has passed: the last set-points are held.
    Holding,
    /// The deadline has passed: the pressures go down.
    Ramping,
}

/// Reason why set-points are limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PressureLimit {
    /// They are not limited.
    None,
    /// No pressure may rise: all IMUs, or all bend sensors of a segment, are lost.
    SensorsLost,
    /// All are zero: the board restarted after repeated crashes.
    SafeMode,
}

/// State of sensors and pressures, counters since boot, and timing since the last message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Health {
    /// Number of the last tick.
    pub tick: u32,
    /// Each bend sensor, two places for each segment.
    pub bend: Vec<SensorHealth, MAX_BEND_SENSORS>,
    /// Each segment's IMU.
    pub imu: Vec<SensorHealth, MAX_SEGMENTS>,
    /// Longest time from a tick's trigger to its estimate since the last message, µs.
    pub max_estimate_latency_us: u32,
    /// Longest time from a tick's trigger to the last IMU's reading since the last message, µs.
    pub longest_imu_read_us: u32,
    /// CPU load since the last message, 0.1 %.
    pub load_permille: u16,
    /// Ticks since boot that began before the previous one was done.
    pub overruns: u32,
    /// ADC scans since boot that were late or out of order.
    pub stale_scans: u32,
    /// Frames since boot that were dropped because the transmit buffer was full.
    pub dropped_frames: u32,
    /// Frames since boot that were received damaged.
    pub damaged_frames: u32,
    /// Whole frames since boot of another version, or of an unknown topic or request.
    pub unknown_frames: u32,
    /// I²C bus recoveries since boot.
    pub bus_recoveries: u32,
    /// Results of the estimator since boot that fixed point could not hold.
    pub saturations: u32,
    /// Conditions that degrade each segment's estimate.
    pub conditions: Vec<Conditions, MAX_SEGMENTS>,
    /// State of the pressures.
    pub actuation: Actuation,
    /// Limit of the set-points.
    pub limit: PressureLimit,
    /// Set-points as they are now, Pa.
    pub pressures_pa: Vec<u32, MAX_REGULATORS>,
}

/// A change of state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// New state of an IMU, counted from 0.
    Imu(u8, SensorState),
    /// New state of a bend sensor, counted from 0.
    Bend(u8, SensorState),
    /// New state of the pressures.
    Actuation(Actuation),
    /// The I²C bus was stuck and has recovered.
    BusRecovery,
    /// The estimator was restarted before the sample of this tick.
    Tare(u32),
    /// Contact began or ended with the sample of this tick; bit i is the contact of segment i, counted from 0.
    Contact(u32, u8),
    /// Conditions of a segment, counted from 0, have changed.
    Condition(u8, Conditions),
}
