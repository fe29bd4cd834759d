//! Protocol 2, in which every arm had six segments, twelve bend sensors and six regulators. A host reads boards and
//! recordings of it, and sends its requests.

use serde::Deserialize;

use crate::body::{read, write};
use crate::bounded::{Text, text};
use crate::message::{
    Actuation, Estimate, Event, Health, Hello, Message, PressureLimit, ResetCause, Sample, SensorHealth, SensorState,
    Uncertainty,
};
use crate::request::{Command, Reply, Request, RequestOutcome};
use crate::topic;
use crate::wire::{EstimateWire, SampleWire, UncertaintyWire};

/// Number of this version, whose requests a host may have to send.
pub const VERSION: u8 = 2;

/// Segments of its arm.
const SEGMENTS: usize = 6;
/// Bend sensors of its arm.
const BEND_SENSORS: usize = 12;
/// Pressure regulators of its arm.
const REGULATORS: usize = 6;

#[derive(Deserialize)]
struct Hello2<'a> {
    protocol: u8,
    schema: u32,
    firmware: Text<16>,
    revision: Text<16>,
    arm: Text<32>,
    table: u32,
    chip: [u8; 16],
    reset: ResetCause,
    boot: u32,
    last_panic: Option<&'a str>,
}

#[derive(Deserialize)]
struct Sample2 {
    tick: [u8; 4],
    time_us: [u8; 8],
    tare_epoch: u8,
    bend_read: [u8; 2],
    imu_read: u8,
    bend: [[u8; 2]; BEND_SENSORS],
    imu: [[[u8; 2]; 4]; SEGMENTS],
}

#[derive(Deserialize)]
struct Estimate2 {
    tick: [u8; 4],
    known: u8,
    segments: [[[u8; 4]; 3]; SEGMENTS],
}

#[derive(Deserialize)]
struct Uncertainty2 {
    tick: [u8; 4],
    theta_known: u8,
    end_known: u8,
    in_contact: u8,
    segments: [(u8, [[u8; 4]; 4]); SEGMENTS],
}

#[derive(Deserialize)]
struct Health2 {
    tick: u32,
    bend: [SensorHealth; BEND_SENSORS],
    imu: [SensorHealth; SEGMENTS],
    max_estimate_latency_us: u32,
    longest_imu_read_us: u32,
    load_permille: u16,
    overruns: u32,
    stale_scans: u32,
    dropped_frames: u32,
    damaged_frames: u32,
    bus_recoveries: u32,
    saturations: u32,
    actuation: Actuation,
    pressures_pa: [u32; REGULATORS],
}

#[derive(Deserialize)]
struct Reply2 {
    id: u32,
    outcome: RequestOutcome,
}

#[derive(Deserialize)]
enum Event2 {
    Imu(u8, SensorState),
    Bend(u8, SensorState),
    Actuation(Actuation),
    BusRecovery,
    Tare(u32),
    Contact(u32, [bool; SEGMENTS]),
}

impl From<Hello2<'_>> for Hello {
    fn from(hello: Hello2<'_>) -> Self {
        let Hello2 { protocol, schema, firmware, revision, arm, table, chip, reset, boot, last_panic } = hello;
        let [segments, bend_sensors, regulators] = [SEGMENTS, BEND_SENSORS, REGULATORS].map(|count| count as u8);
        Self {
            protocol,
            schema,
            firmware,
            revision,
            arm,
            table,
            segments,
            bend_sensors,
            regulators,
            chip,
            reset,
            boot,
            last_panic: last_panic.map(text),
        }
    }
}

impl From<Sample2> for Sample {
    fn from(sample: Sample2) -> Self {
        let Sample2 { tick, time_us, tare_epoch, bend_read, imu_read, bend, imu } = sample;
        let [time_us @ .., _, _] = time_us;
        let (bend, _) = bend.as_chunks();
        let segments = bend.iter().copied().zip(imu).collect();
        SampleWire { tick, time_us, tare_epoch, bend_read, imu_read, segments }.into()
    }
}

impl From<Estimate2> for Estimate {
    fn from(estimate: Estimate2) -> Self {
        let Estimate2 { tick, known, segments } = estimate;
        EstimateWire { tick, known, segments: segments.into_iter().collect() }.into()
    }
}

impl From<Uncertainty2> for Uncertainty {
    fn from(uncertainty: Uncertainty2) -> Self {
        let Uncertainty2 { tick, theta_known, end_known, in_contact, segments } = uncertainty;
        let segments = segments.into_iter().collect();
        UncertaintyWire { tick, theta_known, end_known, in_contact, segments }.into()
    }
}

impl From<Health2> for Health {
    fn from(health: Health2) -> Self {
        Self {
            tick: health.tick,
            bend: health.bend.into_iter().collect(),
            imu: health.imu.into_iter().collect(),
            max_estimate_latency_us: health.max_estimate_latency_us,
            longest_imu_read_us: health.longest_imu_read_us,
            load_permille: health.load_permille,
            overruns: health.overruns,
            stale_scans: health.stale_scans,
            dropped_frames: health.dropped_frames,
            damaged_frames: health.damaged_frames,
            bus_recoveries: health.bus_recoveries,
            unknown_frames: 0,
            saturations: health.saturations,
            conditions: heapless::Vec::new(),
            actuation: health.actuation,
            limit: PressureLimit::None,
            pressures_pa: health.pressures_pa.into_iter().collect(),
        }
    }
}

impl From<Event2> for Event {
    fn from(event: Event2) -> Self {
        match event {
            Event2::Imu(imu, state) => Self::Imu(imu, state),
            Event2::Bend(sensor, state) => Self::Bend(sensor, state),
            Event2::Actuation(actuation) => Self::Actuation(actuation),
            Event2::BusRecovery => Self::BusRecovery,
            Event2::Tare(tick) => Self::Tare(tick),
            Event2::Contact(tick, touched) => {
                Self::Contact(tick, touched.iter().rev().fold(0, |mask, touched| mask << 1 | u8::from(*touched)))
            }
        }
    }
}

impl From<Reply2> for Reply {
    fn from(Reply2 { id, outcome }: Reply2) -> Self {
        Self { id, session: 0, outcome }
    }
}

/// Reads a body whose layout is another one now; the outer `None`: it is the same as now.
pub fn read_message(topic: u8, body: &[u8]) -> Option<Option<Message>> {
    let message = match topic {
        topic::HELLO => read(body).map(|hello: Hello2<'_>| Message::Hello(hello.into())),
        topic::SAMPLE => read(body).map(|sample: Sample2| Message::Sample(sample.into())),
        topic::ESTIMATE => read(body).map(|estimate: Estimate2| Message::Estimate(estimate.into())),
        topic::HEALTH => read(body).map(|health: Health2| Message::Health(health.into())),
        topic::EVENT => read(body).map(|event: Event2| Message::Event(event.into())),
        topic::REPLY => read(body).map(|reply: Reply2| Message::Reply(reply.into())),
        topic::UNCERTAINTY => read(body).map(|uncertainty: Uncertainty2| Message::Uncertainty(uncertainty.into())),
        _ => return None,
    };
    Some(message)
}

/// Place of `Tare` among the commands.
const TARE: u8 = 1;
/// Place of `SetPressures` among the commands.
const SET_PRESSURES: u8 = 5;

/// Writes the body of a request and returns its length; `None` if it does not fit, or has set-points for another number of
/// regulators.
pub fn write_request(request: &Request, body: &mut [u8]) -> Option<usize> {
    match &request.command {
        Command::Tare(_) => write(&(request.id, TARE), body),
        Command::SetPressures(set) => {
            let pressures_pa: &[u32; REGULATORS] = set.pressures_pa.as_slice().try_into().ok()?;
            write(&(request.id, SET_PRESSURES, pressures_pa, set.valid_ms), body)
        }
        command => write(&(request.id, command), body),
    }
}
