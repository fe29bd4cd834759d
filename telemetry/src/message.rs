//! What board and host say to each other.
//!
//! Units on the wire are SI: µs, rad, m, Pa. Angles and lengths are the estimator's own bits, so that nothing is lost.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::wire::{EstimateWire, SampleWire, UncertaintyWire};

/// Time between two ticks of the board, µs.
pub const TICK_US: u64 = 10_000;

/// Ticks a second: the rate of samples and estimates, unless the host requests a lower one.
pub const TICK_HZ: f64 = 1e6 / TICK_US as f64;

/// Segments of the arm.
pub const SEGMENTS: usize = 6;

/// Bend sensors of the arm, in the order 1a, 1b, 2a … 6b.
pub const BEND_SENSORS: usize = 12;

/// Pressure regulators of the arm: module 1 right, left, module 2 right, left, module 3 right, left.
pub const REGULATORS: usize = 6;

/// A short text, cut where it is too long.
pub type Text<const N: usize> = heapless::String<N>;

/// What the board says.
#[derive(Debug, Clone, PartialEq, Schema)]
pub enum Message {
    /// Who it is; on request and once a second.
    Hello(Hello),
    /// What it read in one tick.
    Sample(Sample),
    /// What the estimator made of it.
    Estimate(Estimate),
    /// How it is.
    Health(Health),
    /// What has happened.
    Event(Event),
    /// The answer to a request.
    Reply(Reply),
    /// How far an estimate may be off.
    Uncertainty(Uncertainty),
}

/// Who the board is and how it came up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Schema)]
pub struct Hello {
    /// Version of this protocol.
    pub protocol: u8,
    /// Hash of the messages' schema.
    pub schema: u32,
    /// Version of the firmware.
    pub firmware: Text<16>,
    /// Revision of the firmware's source.
    pub revision: Text<16>,
    /// Name of the arm that its table is for.
    pub arm: Text<32>,
    /// Checksum of its table.
    pub table: u32,
    /// Unique number of its chip.
    pub chip: [u8; 16],
    /// What started it.
    pub reset: ResetCause,
    /// Number of this boot since power-on.
    pub boot: u32,
    /// What the last panic or fault before this boot said.
    pub last_panic: Option<Text<96>>,
}

/// What started the board (datasheet, RSTC_SR).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ResetCause {
    /// Power came on.
    PowerOn,
    /// Back from the backup mode.
    Backup,
    /// The watchdog.
    Watchdog,
    /// The firmware itself.
    Software,
    /// The reset pin: the button, or a host that opened the port.
    Pin,
}

/// What the board read in one tick: all that a replay needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "SampleWire", from = "SampleWire")]
pub struct Sample {
    /// Number of the tick since boot.
    pub tick: u32,
    /// Time of the tick since boot, µs.
    pub time_us: u64,
    /// Goes up by one where the estimator started anew before this sample: at boot it is 0, then once for each tare.
    pub tare: u8,
    /// Raw ADC counts; `None`: not read.
    pub bend: [Option<u16>; BEND_SENSORS],
    /// Raw quaternion w, x, y, z of each IMU, in units of 2⁻¹⁴; `None`: not read.
    pub imu: [Option<[i16; 4]>; SEGMENTS],
}

/// The arm's shape by the Kalman filters, in the bits of `estimator_core::Q`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "EstimateWire", from = "EstimateWire")]
pub struct Estimate {
    /// Number of the tick whose sample it was made of.
    pub tick: u32,
    /// The segments, from the base; `None`: not known yet.
    pub segments: [Option<SegmentEstimate>; SEGMENTS],
}

/// One segment's estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SegmentEstimate {
    /// Bend angle θ_i, rad, in units of 2⁻²⁶.
    pub theta: i32,
    /// World position x, y of the segment's end, m, in units of 2⁻²⁶.
    pub end: [i32; 2],
}

/// How far an estimate may be off and what touches the arm, in the bits of `estimator_core::Q`, whose variances are 64 times
/// as large as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "UncertaintyWire", from = "UncertaintyWire")]
pub struct Uncertainty {
    /// Number of the tick whose estimate it is of.
    pub tick: u32,
    /// The segments, from the base.
    pub segments: [SegmentUncertainty; SEGMENTS],
}

/// What is known of one segment's error, and whether something touches it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SegmentUncertainty {
    /// Variance of θ_i, rad², in units of 2⁻³²; `None`: not known.
    pub theta: Option<i32>,
    /// Covariance xx, xy, yy of the segment's end in {W}, m², in units of 2⁻³²; `None`: not known.
    pub end: Option<[i32; 3]>,
    /// The largest change within half a second, in percent of what a free arm does not exceed; stays at its largest value.
    pub contact_percent: u8,
    /// Whether something touches it: from over 100 % on, until the change is undone, or for a minute.
    pub is_touched: bool,
}

/// State of one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum SensorState {
    /// It reads well.
    Ok,
    /// It does not answer, or reads at a rail.
    Off,
    /// It repeats itself while others move.
    Stuck,
    /// What it says cannot be.
    Garbage,
    /// What it says contradicts the others.
    Wrong,
    /// It answers too late.
    Slow,
    /// It comes and goes.
    Intermittent,
}

/// State of one sensor, and how often it failed since boot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SensorHealth {
    /// State now.
    pub state: SensorState,
    /// Ticks without a good reading since boot; stays at its largest value.
    pub missed: u16,
}

/// State of the pressures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
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

/// How the board is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Health {
    /// Number of the last tick.
    pub tick: u32,
    /// Each bend sensor.
    pub bend: [SensorHealth; BEND_SENSORS],
    /// Each IMU.
    pub imu: [SensorHealth; SEGMENTS],
    /// Longest time from a tick's trigger to its estimate since the last message, µs.
    pub longest_tick_us: u32,
    /// Longest time that the six IMUs took since the last message, µs from the tick's trigger.
    pub longest_imu_read_us: u32,
    /// Share of the processor's time that was used since the last message, 0.1 %.
    pub load_permille: u16,
    /// Ticks since boot that came before the one before was done.
    pub overruns: u32,
    /// ADC scans since boot that were late or out of order.
    pub stale_scans: u32,
    /// Frames since boot that found the line full.
    pub dropped_frames: u32,
    /// Frames since boot that were received damaged.
    pub damaged_frames: u32,
    /// I²C bus recoveries since boot.
    pub bus_recoveries: u32,
    /// Results of the estimator since boot that fixed point could not hold.
    pub saturations: u32,
    /// State of the pressures.
    pub actuation: Actuation,
    /// Set-points as they are now, Pa.
    pub pressures_pa: [u32; REGULATORS],
}

/// What has happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Event {
    /// An IMU, counted from 0, changed its state.
    Imu(u8, SensorState),
    /// A bend sensor, counted from 0, changed its state.
    Bend(u8, SensorState),
    /// The pressures changed their state.
    Actuation(Actuation),
    /// The I²C bus was found stuck and cleared.
    BusRecovery,
    /// The estimator started anew, before the sample of this tick.
    Tare(u32),
    /// Contact has begun or ended somewhere with the sample of this tick: whether something touches each segment.
    Contact(u32, [bool; SEGMENTS]),
}

/// What the host asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Request {
    /// The host's number of the request. A retried request keeps its number and acts once; numbers go up.
    pub id: u32,
    /// What to do.
    pub command: Command,
}

/// What the board can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Command {
    /// Nothing but answer, with a [`Hello`] behind it.
    Ping,
    /// Start the estimator anew: the arm is in its reference pose.
    Tare,
    /// Send every n-th of the messages that tell of every tick; 0: none.
    Rates(Rates),
    /// Let the pressures move.
    Arm,
    /// Vent, and let nothing move the pressures until armed again.
    Disarm,
    /// Set the pressures.
    SetPressures(SetPressures),
    /// Vent and restart.
    Reboot,
}

/// How often messages are sent, in ticks of 10 ms; 0: never.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Rates {
    /// Ticks from one sample to the next.
    pub sample: u16,
    /// Ticks from one estimate to the next.
    pub estimate: u16,
    /// Ticks from one health message to the next.
    pub health: u16,
    /// Ticks from one uncertainty to the next.
    pub uncertainty: u16,
}

/// Set-points with a deadline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SetPressures {
    /// Pressure of each regulator over the atmosphere's, Pa.
    pub pressures_pa: [u32; REGULATORS],
    /// How long they stand without a new request, ms; then they are held, lowered and vented.
    pub valid_ms: u16,
}

/// The answer to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Reply {
    /// The request's number.
    pub id: u32,
    /// Whether it was done.
    pub outcome: Outcome,
}

/// Whether a request was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Outcome {
    /// It was done.
    Ack,
    /// It was not, and nothing has changed.
    Nack(Refusal),
}

/// Why a request was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Schema, thiserror::Error)]
pub enum Refusal {
    /// The frame was whole but its body is no request of this protocol's version.
    #[error("the board does not know this request: host and firmware are of different versions")]
    Unknown,
    /// Its number is lower than one already seen.
    #[error("the request is older than one already done")]
    Late,
    /// A pressure is over the regulator's range.
    #[error("a pressure is over the regulator's range")]
    OverRange,
    /// The deadline is zero or too far away.
    #[error("the time that the pressures stand must be 1 ms to 1000 ms")]
    Deadline,
    /// The pressures move only when armed.
    #[error("the pressures are not armed: arm first")]
    Disarmed,
    /// Too many requests at once.
    #[error("too many requests: wait and try again")]
    Busy,
}
