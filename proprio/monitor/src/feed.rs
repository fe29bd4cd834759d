//! Messages to the page, as JSON.

use calibration_tables::{ArmFile, Side};
use estimator_core::Q;
use proprio_link::status::MessageRates;
use proprio_link::{LinkState, Mismatch};
use proprio_session::ClockDrift;
use serde::Serialize;
use telemetry::{Actuation, Health, SensorHealth, SensorState, TICK_HZ};

use super::latency::Percentiles;
use super::page_row::{self, ArmSize};
use super::recording::RecordingProgress;
use super::sweep::SweepStatus;

/// A message to the page.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(super) enum Feed<'a> {
    /// First message, and again where a board has another number of segments.
    Arm(&'a ArmDescription),
    Rows(Batch),
    Status(Box<PageStatus>),
    Delivery(Delivery),
}

impl Feed<'_> {
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("numbers and names have a form in JSON")
    }
}

/// Delivery of rows to one page.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Delivery {
    /// Latency from the sample to its screen; `None` before its first report.
    pub latency: Option<Percentiles>,
    /// Batches that were dropped for newer ones, as the page was slow.
    pub skipped: u64,
}

/// Description of the arm and of what the page can do.
#[derive(Debug, Clone, Serialize)]
pub(super) struct ArmDescription {
    /// Version of this program.
    pub proprio: &'static str,
    #[serde(flatten)]
    pub size: ArmSize,
    pub columns: Vec<String>,
    /// Geometry of each segment; `None` without a table.
    pub geometry: Option<Vec<Geometry>>,
    /// Arm and checksum of the table; `None` without a table.
    pub table: Option<String>,
    /// A board is connected.
    pub is_live: bool,
    /// The page may send requests to the board.
    pub allows_control: bool,
    /// The session to open at once.
    pub session: Option<String>,
}

impl ArmDescription {
    pub fn new(size: ArmSize, table: Option<&ArmFile>) -> Self {
        let checksum = |table: &ArmFile| Some(table.compile::<Q>(TICK_HZ).ok()?.checksum());
        Self {
            proprio: env!("CARGO_PKG_VERSION"),
            size,
            columns: page_row::names(size),
            geometry: table.map(|table| table.segments.iter().map(Geometry::from).collect()),
            table: table.and_then(|table| Some(format!("{}, checksum {:08x}", table.arm, checksum(table)?))),
            is_live: false,
            allows_control: false,
            session: None,
        }
    }

    /// The same page for an arm of another size, or with the table that is known now.
    pub fn with(&self, size: ArmSize, table: Option<&ArmFile>) -> Self {
        let Self { is_live, allows_control, ref session, .. } = *self;
        Self { is_live, allows_control, session: session.clone(), ..Self::new(size, table) }
    }
}

/// Geometry of a segment.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Geometry {
    length_mm: f64,
    offset_mm: f64,
    /// The connector follows the curved part.
    offset_at_end: bool,
}

impl From<&calibration_tables::SegmentToml> for Geometry {
    fn from(segment: &calibration_tables::SegmentToml) -> Self {
        let offset_at_end = segment.offset_at == Side::End;
        Self { length_mm: segment.length_mm, offset_mm: segment.offset_mm, offset_at_end }
    }
}

/// Data since the last batch.
#[derive(Debug, Default, Serialize)]
pub(super) struct Batch {
    /// Time of each row, s, and its values in the order of [`ArmDescription::columns`].
    pub rows: Vec<(f64, Vec<f32>)>,
    /// Time of the last sample, µs by this program's clock: the page sends it back once it has drawn the row.
    pub newest_us: u64,
    /// Time of the batch by the same clock, µs: the page sends it back when it has received it.
    pub sent_us: u64,
}

/// Status of board and link.
#[derive(Debug, Serialize)]
pub(super) struct PageStatus {
    /// Name of the line; `None` while it is gone.
    pub port: Option<String>,
    /// Reason why no line could be opened yet; `None` once one was.
    pub waiting: Option<String>,
    pub answers: bool,
    pub board: Option<BoardInfo>,
    /// The board has another table than the monitor, or none.
    pub offers_table: bool,
    pub health: Option<BoardHealth>,
    pub sensors: Vec<SensorStatus>,
    #[serde(flatten)]
    pub rates: MessageRates,
    pub frames: u32,
    pub damaged: u32,
    pub lost: u32,
    pub restarts: u32,
    /// Events that were dropped because this program was too slow.
    pub dropped_events: u64,
    pub clock: Option<BoardTime>,
    /// The part of the latency from the sample to the screen that is computed and not measured: the board's latency and the frame on the line.
    pub least_delay_ms: Option<f64>,
    pub recording: Option<RecordingProgress>,
    /// The sweep for a calibration; `None` before the first row.
    pub sweep: Option<SweepStatus>,
    /// Warnings for people.
    pub notes: Vec<String>,
    /// Findings of the session check since the board's last tare, with their remedies.
    pub findings: Vec<String>,
}

/// Identity of the board.
#[derive(Debug, Serialize)]
pub(super) struct BoardInfo {
    arm: String,
    segments: u8,
    /// Bend sensors that are wired.
    bend_sensors: u8,
    regulators: u8,
    /// Checksum of its table; `None` without a table.
    table: Option<String>,
    firmware: String,
    boot: u32,
    reset: telemetry::ResetCause,
    last_panic: Option<String>,
}

/// Health of the board.
#[derive(Debug, Serialize)]
pub(super) struct BoardHealth {
    load_percent: f64,
    longest_tick_ms: f64,
    overruns: u32,
    dropped_frames: u32,
    bus_recoveries: u32,
    saturations: u32,
    actuation: Actuation,
    pressures_kpa: Vec<f64>,
}

impl From<&Health> for BoardHealth {
    fn from(health: &Health) -> Self {
        Self {
            load_percent: f64::from(health.load_permille) / 10.0,
            longest_tick_ms: f64::from(health.max_estimate_latency_us) / 1e3,
            overruns: health.overruns,
            dropped_frames: health.dropped_frames,
            bus_recoveries: health.bus_recoveries,
            saturations: health.saturations,
            actuation: health.actuation,
            pressures_kpa: health.pressures_pa.iter().map(|pressure_pa| f64::from(*pressure_pa) / 1e3).collect(),
        }
    }
}

/// Status of a sensor.
#[derive(Debug, Serialize)]
pub(super) struct SensorStatus {
    pub state: SensorState,
    pub reason: &'static str,
    pub missed: u16,
}

impl From<SensorHealth> for SensorStatus {
    fn from(SensorHealth { state, missed }: SensorHealth) -> Self {
        let reason = match state {
            SensorState::Ok => "reads well",
            SensorState::NoResponse => "does not answer, or reads at a rail",
            SensorState::Stuck => "repeats itself while others move",
            SensorState::Invalid => "answers with invalid data",
            SensorState::Inconsistent => "contradicts the others",
            SensorState::Timeout => "answers too late",
            SensorState::Intermittent => "comes and goes",
            SensorState::NotWired => "is not wired",
        };
        Self { state, reason, missed }
    }
}

/// The board's clock against the host's.
#[derive(Debug, Serialize)]
pub(super) struct BoardTime {
    /// The board's time 0, ms since 1970, UTC.
    pub zero_ms: f64,
    pub drift: Option<ClockDrift>,
}

impl PageStatus {
    /// The status of the link; the other fields are empty.
    pub fn new(link: LinkState, rates: MessageRates) -> Self {
        let board = link.hello.map(|hello| BoardInfo {
            arm: hello.arm.as_str().to_owned(),
            segments: hello.segments,
            bend_sensors: hello.bend_sensors,
            regulators: hello.regulators,
            table: (hello.table != 0).then(|| format!("{:08x}", hello.table)),
            firmware: hello.firmware.as_str().to_owned(),
            boot: hello.boot,
            reset: hello.reset,
            last_panic: hello.last_panic.map(|message| message.as_str().to_owned()),
        });
        Self {
            port: link.port,
            waiting: link.waiting,
            answers: link.is_connected,
            board,
            offers_table: link.mismatches.iter().any(Mismatch::is_table),
            health: None,
            sensors: Vec::new(),
            rates,
            frames: link.counts.received,
            damaged: link.counts.damaged,
            lost: link.counts.lost,
            restarts: link.restarts,
            dropped_events: 0,
            clock: None,
            least_delay_ms: None,
            recording: None,
            sweep: None,
            findings: Vec::new(),
            notes: link.mismatches.iter().map(ToString::to_string).collect(),
        }
    }
}
