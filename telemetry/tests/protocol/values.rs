//! Messages with any values at all, and with those that take the most bytes.

use heapless::Vec;
use proptest::prelude::*;
use proptest::sample::select;
use telemetry::*;

/// Any number, its extremes often.
macro_rules! number {
    ($type:ty) => {
        prop_oneof![2 => any::<$type>(), 1 => select(vec![<$type>::MIN, <$type>::MAX, 0, 1])]
    };
}

pub fn message() -> impl Strategy<Value = Message> {
    prop_oneof![
        hello().prop_map(Message::Hello),
        sample().prop_map(Message::Sample),
        estimate().prop_map(Message::Estimate),
        health().prop_map(Message::Health),
        event().prop_map(Message::Event),
        reply().prop_map(Message::Reply),
        uncertainty().prop_map(Message::Uncertainty),
        table_state().prop_map(Message::Table),
        chunk().prop_map(Message::TableData),
        tare_report().prop_map(Message::Tare),
    ]
}

/// A list of any length up to its room.
fn list<T: Clone + std::fmt::Debug, const N: usize>(of: impl Strategy<Value = T>) -> impl Strategy<Value = Vec<T, N>> {
    prop::collection::vec(of, 0..=N).prop_map(|values| values.into_iter().collect())
}

/// A list of this length.
fn exactly<T: Clone + std::fmt::Debug, const N: usize>(
    length: usize,
    of: impl Strategy<Value = T>,
) -> impl Strategy<Value = Vec<T, N>> {
    prop::collection::vec(of, length).prop_map(|values| values.into_iter().collect())
}

fn tare_report() -> impl Strategy<Value = TareReport> {
    let angle = || prop::option::of((number!(u8), number!(i32)));
    (number!(u32), angle(), angle()).prop_map(|(id, turned, bent)| TareReport { id, turned, bent })
}

pub fn request() -> impl Strategy<Value = Request> {
    let rates = prop::array::uniform4(number!(u16)).prop_map(|[sample, estimate, health, uncertainty]| {
        Command::Rates(Rates { sample, estimate, health, uncertainty })
    });
    let pressures = (list(number!(u32)), number!(u16))
        .prop_map(|(pressures_pa, valid_ms)| Command::SetPressures(SetPressures { pressures_pa, valid_ms }));
    let plain = select(vec![
        Command::Ping,
        Command::Tare(TareMode::IfStill),
        Command::Tare(TareMode::Force),
        Command::Arm,
        Command::Disarm,
        Command::Reboot,
    ]);
    let table = prop_oneof![
        prop::array::uniform3(number!(u32)).prop_map(|[image_bytes, source_bytes, crc]| {
            Command::TableBegin(TableAnnouncement { image_bytes, source_bytes, crc })
        }),
        chunk().prop_map(Command::TableWrite),
        number!(u32).prop_map(Command::TableRead),
        select(vec![Command::TableCommit, Command::TableErase]),
    ];
    (number!(u32), number!(u16), prop_oneof![plain, rates, pressures, table])
        .prop_map(|(id, session, command)| Request { id, session, command })
}

fn chunk() -> impl Strategy<Value = TableChunk> {
    let bytes = prop::collection::vec(any::<u8>(), 0..=TABLE_CHUNK_BYTES);
    (number!(u32), bytes).prop_map(|(offset, bytes)| TableChunk { offset, bytes: bytes.into_iter().collect() })
}

fn table_state() -> impl Strategy<Value = TableState> {
    let status = select(vec![
        TableStatus::InUse,
        TableStatus::Missing,
        TableStatus::Damaged,
        TableStatus::Foreign,
        TableStatus::Unusable,
    ]);
    (status, prop::array::uniform5(number!(u32))).prop_map(|(status, numbers)| {
        let [generation, image_bytes, source_bytes, crc, received_bytes] = numbers;
        TableState { status, generation, image_bytes, source_bytes, crc, received_bytes }
    })
}

fn text<const N: usize>() -> impl Strategy<Value = Text<N>> {
    prop::collection::vec(any::<char>(), 0..=N).prop_map(|chars| {
        let mut text = Text::new();
        let _ = chars.into_iter().try_for_each(|char| text.push(char));
        text
    })
}

fn hello() -> impl Strategy<Value = Hello> {
    let reset = select(vec![
        ResetCause::PowerOn,
        ResetCause::Backup,
        ResetCause::Watchdog,
        ResetCause::Software,
        ResetCause::Pin,
    ]);
    let texts = (text(), text(), text(), prop::option::of(text()));
    let numbers = (number!(u8), number!(u32), number!(u32), number!(u32));
    (texts, numbers, any::<[u8; 19]>(), reset).prop_map(
        |(
            (firmware, revision, arm, last_panic),
            (protocol, schema, table, boot),
            [segments, bend_sensors, regulators, chip @ ..],
            reset,
        )| Hello {
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
            last_panic,
        },
    )
}

/// Of any arm.
pub fn sample() -> impl Strategy<Value = Sample> {
    (0..=MAX_SEGMENTS).prop_flat_map(sample_of)
}

/// Of an arm of so many segments.
pub fn sample_of(segments: usize) -> impl Strategy<Value = Sample> {
    let bend = exactly(BEND_PER_SEGMENT * segments, prop::option::of(number!(u16)));
    let imu = exactly(segments, prop::option::of(prop::array::uniform4(number!(i16))));
    let time_us = number!(u64).prop_map(|time_us| time_us >> 16);
    (number!(u32), time_us, number!(u8), bend, imu).prop_map(|(tick, time_us, tare_epoch, bend, imu)| Sample {
        tick,
        time_us,
        tare_epoch,
        bend,
        imu,
    })
}

fn estimate() -> impl Strategy<Value = Estimate> {
    let segment = (number!(i32), prop::array::uniform2(number!(i32)));
    let segment = segment.prop_map(|(theta, end)| SegmentEstimate { theta, end });
    let segments = list(prop::option::of(segment));
    (number!(u32), segments).prop_map(|(tick, segments)| Estimate { tick, segments })
}

fn uncertainty() -> impl Strategy<Value = Uncertainty> {
    let end = prop::option::of(prop::array::uniform3(number!(i32)));
    let segment = (prop::option::of(number!(i32)), end, number!(u8), any::<bool>()).prop_map(
        |(theta, end, contact_percent, in_contact)| SegmentUncertainty { theta, end, contact_percent, in_contact },
    );
    (number!(u32), list(segment)).prop_map(|(tick, segments)| Uncertainty { tick, segments })
}

fn sensor_state() -> impl Strategy<Value = SensorState> {
    select(vec![
        SensorState::Ok,
        SensorState::NoResponse,
        SensorState::Stuck,
        SensorState::Invalid,
        SensorState::Inconsistent,
        SensorState::Timeout,
        SensorState::Intermittent,
        SensorState::NotWired,
    ])
}

fn actuation() -> impl Strategy<Value = Actuation> {
    select(vec![Actuation::Disarmed, Actuation::Armed, Actuation::Holding, Actuation::Ramping])
}

fn health() -> impl Strategy<Value = Health> {
    let sensor = || (sensor_state(), number!(u16)).prop_map(|(state, missed)| SensorHealth { state, missed });
    let sensors = (list(sensor()), list(sensor()), list(number!(u8).prop_map(Conditions)));
    let numbers = prop::array::uniform10(number!(u32));
    let limit = select(vec![PressureLimit::None, PressureLimit::SensorsLost, PressureLimit::SafeMode]);
    let pressures = (actuation(), limit, list(number!(u32)));
    (sensors, numbers, number!(u16), pressures).prop_map(
        |((bend, imu, conditions), numbers, load_permille, (actuation, limit, pressures_pa))| {
            let [tick, max_estimate_latency_us, longest_imu_read_us, overruns, stale_scans, counts @ ..] = numbers;
            let [dropped_frames, damaged_frames, unknown_frames, bus_recoveries, saturations] = counts;
            Health {
                tick,
                bend,
                imu,
                max_estimate_latency_us,
                longest_imu_read_us,
                load_permille,
                overruns,
                stale_scans,
                dropped_frames,
                damaged_frames,
                unknown_frames,
                bus_recoveries,
                saturations,
                conditions,
                actuation,
                limit,
                pressures_pa,
            }
        },
    )
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        (number!(u8), sensor_state()).prop_map(|(imu, state)| Event::Imu(imu, state)),
        (number!(u8), sensor_state()).prop_map(|(bend, state)| Event::Bend(bend, state)),
        actuation().prop_map(Event::Actuation),
        Just(Event::BusRecovery),
        number!(u32).prop_map(Event::Tare),
        (number!(u32), number!(u8)).prop_map(|(tick, touched)| Event::Contact(tick, touched)),
        (number!(u8), number!(u8)).prop_map(|(segment, bits)| Event::Condition(segment, Conditions(bits))),
    ]
}

fn reply() -> impl Strategy<Value = Reply> {
    let refusal = select(vec![
        Refusal::Unknown,
        Refusal::Late,
        Refusal::OverRange,
        Refusal::Deadline,
        Refusal::Disarmed,
        Refusal::Busy,
        Refusal::Armed,
        Refusal::NoTable,
        Refusal::TableTooLong,
        Refusal::TableCapacity,
        Refusal::TableImage,
        Refusal::TableOrder,
        Refusal::TableChecksum,
        Refusal::Flash,
        Refusal::Moving,
        Refusal::Regulators,
        Refusal::TableWiring,
        Refusal::Session,
        Refusal::SafeMode,
    ]);
    let done = select(vec![RequestOutcome::Ack, RequestOutcome::Limited]);
    let outcome = prop_oneof![done, refusal.prop_map(RequestOutcome::Nack)];
    (number!(u32), number!(u16), outcome).prop_map(|(id, session, outcome)| Reply { id, session, outcome })
}

/// A ping, the shortest request.
pub fn ping(id: u32) -> Request {
    Request { id, session: 0, command: Command::Ping }
}

/// Of each kind the message of the largest arm that takes the most bytes.
pub fn longest_messages() -> [Message; 10] {
    longest_messages_of(MAX_SEGMENTS, MAX_REGULATORS)
}

/// So many of the same value.
pub fn many<T: Clone, const N: usize>(count: usize, value: T) -> Vec<T, N> {
    std::iter::repeat_n(value, count).collect()
}

/// Of each kind the message of an arm of so many segments and regulators that takes the most bytes.
pub fn longest_messages_of(segments: usize, regulators: usize) -> [Message; 10] {
    let uncertain = SegmentUncertainty {
        theta: Some(i32::MIN),
        end: Some([i32::MIN; 3]),
        contact_percent: u8::MAX,
        in_contact: true,
    };
    [
        Message::Hello(longest_hello()),
        Message::Sample(Sample {
            tick: u32::MAX,
            time_us: u64::MAX >> 16,
            tare_epoch: u8::MAX,
            bend: many(BEND_PER_SEGMENT * segments, Some(u16::MAX)),
            imu: many(segments, Some([i16::MIN; 4])),
        }),
        Message::Estimate(Estimate {
            tick: u32::MAX,
            segments: many(segments, Some(SegmentEstimate { theta: i32::MIN, end: [i32::MIN; 2] })),
        }),
        Message::Health(longest_health(segments, regulators)),
        Message::Event(Event::Contact(u32::MAX, u8::MAX)),
        Message::Reply(Reply { id: u32::MAX, session: u16::MAX, outcome: RequestOutcome::Nack(Refusal::Busy) }),
        Message::Uncertainty(Uncertainty { tick: u32::MAX, segments: many(segments, uncertain) }),
        Message::Table(TableState {
            status: TableStatus::Unusable,
            generation: u32::MAX,
            image_bytes: u32::MAX,
            source_bytes: u32::MAX,
            crc: u32::MAX,
            received_bytes: u32::MAX,
        }),
        Message::TableData(longest_chunk()),
        Message::Tare(TareReport { id: u32::MAX, turned: Some((7, i32::MIN)), bent: Some((7, i32::MIN)) }),
    ]
}

fn longest_chunk() -> TableChunk {
    TableChunk { offset: u32::MAX, bytes: [u8::MAX; TABLE_CHUNK_BYTES].into_iter().collect() }
}

fn full<const N: usize>() -> Text<N> {
    Text::try_from("x".repeat(N).as_str()).expect("N bytes")
}

pub fn longest_hello() -> Hello {
    Hello {
        protocol: u8::MAX,
        schema: u32::MAX,
        firmware: full(),
        revision: full(),
        arm: full(),
        table: u32::MAX,
        segments: u8::MAX,
        bend_sensors: u8::MAX,
        regulators: u8::MAX,
        chip: [u8::MAX; 16],
        reset: ResetCause::Pin,
        boot: u32::MAX,
        last_panic: Some(full()),
    }
}

fn longest_health(segments: usize, regulators: usize) -> Health {
    let sensor = SensorHealth { state: SensorState::Intermittent, missed: u16::MAX };
    Health {
        tick: u32::MAX,
        bend: many(BEND_PER_SEGMENT * segments, sensor),
        imu: many(segments, sensor),
        max_estimate_latency_us: u32::MAX,
        longest_imu_read_us: u32::MAX,
        load_permille: u16::MAX,
        overruns: u32::MAX,
        stale_scans: u32::MAX,
        dropped_frames: u32::MAX,
        damaged_frames: u32::MAX,
        unknown_frames: u32::MAX,
        bus_recoveries: u32::MAX,
        saturations: u32::MAX,
        conditions: many(segments, Conditions(u8::MAX)),
        actuation: Actuation::Ramping,
        limit: PressureLimit::SafeMode,
        pressures_pa: many(regulators, u32::MAX),
    }
}

/// The request that takes the most bytes.
pub fn longest_request() -> Request {
    Request { id: u32::MAX, session: u16::MAX, command: Command::TableWrite(longest_chunk()) }
}
