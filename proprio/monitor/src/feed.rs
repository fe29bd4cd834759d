//! What the page is told, as JSON.

use calibration_tables::{ArmFile, Side};
use proprio_link::LinkState;
use proprio_link::status::Rates;
use proprio_session::Drift;
use serde::Serialize;
use telemetry::{Actuation, Health, SEGMENTS, SegmentUncertainty, SensorHealth, SensorState};

use super::latency::Percentiles;
use super::recording::Progress;
use super::row;

/// A message to the page.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(super) enum Feed<'a> {
    /// First of all.
    Arm(&'a Arm),
    Rows(Batch),
    Status(Box<Status>),
    /// This page was too slow: so many messages are not sent to it.
    Skipped {
        messages: u64,
    },
}

impl Feed<'_> {
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("numbers and names have a form in JSON")
    }
}

/// What there is to be shown.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Arm {
    /// Version of this program.
    pub proprio: &'static str,
    pub segments: usize,
    pub columns: Vec<String>,
    /// Of each segment, where a table says it.
    pub geometry: Option<Vec<Geometry>>,
    /// Whether there is a board.
    pub is_live: bool,
    /// Whether the page may ask the board for something.
    pub allows_control: bool,
    /// Whether sessions can be opened, which takes a table.
    pub opens_sessions: bool,
    /// The session to open at once.
    pub session: Option<String>,
}

impl Arm {
    pub fn new(segments: usize, table: Option<&ArmFile>) -> Self {
        Self {
            proprio: env!("CARGO_PKG_VERSION"),
            segments,
            columns: row::names(segments),
            geometry: table.map(|table| table.segments.iter().map(Geometry::from).collect()),
            is_live: false,
            allows_control: false,
            opens_sessions: table.is_some(),
            session: None,
        }
    }
}

/// A segment.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Geometry {
    length_mm: f64,
    offset_mm: f64,
    /// The connector follows the curved part.
    offset_at_end: bool,
}

impl From<&calibration_tables::SegmentKeys> for Geometry {
    fn from(segment: &calibration_tables::SegmentKeys) -> Self {
        let offset_at_end = segment.offset_at == Side::End;
        Self { length_mm: segment.length_mm, offset_mm: segment.offset_mm, offset_at_end }
    }
}

/// What came since the message before.
#[derive(Debug, Default, Serialize)]
pub(super) struct Batch {
    /// Time of each row, s, and its values in the order of [`Arm::columns`].
    pub rows: Vec<(f64, Vec<f32>)>,
    /// When the last one was sampled, µs by this program's clock: the page sends it back once it has drawn it.
    pub newest_us: u64,
    /// How well the shape is known, where the board knows it.
    pub uncertainty: Option<Uncertainty>,
    /// Which segments touch something.
    pub contact: Option<[bool; SEGMENTS]>,
}

/// How well the shape is known.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Uncertainty {
    /// Covariance xx, xy, yy of each segment's end in {W}, m².
    pub ends_m2: Vec<[f64; 3]>,
}

impl Uncertainty {
    /// As far as it is known; `None` where nothing is.
    pub fn of(told: &telemetry::Uncertainty) -> Option<Self> {
        let ends_m2: Vec<_> = told.segments.iter().map_while(SegmentUncertainty::end_m2).collect();
        (!ends_m2.is_empty()).then_some(Self { ends_m2 })
    }
}

/// How board and link are.
#[derive(Debug, Serialize)]
pub(super) struct Status {
    /// Name of the line; `None` while it is gone.
    pub port: Option<String>,
    pub answers: bool,
    pub board: Option<Board>,
    pub health: Option<BoardHealth>,
    pub sensors: Vec<Sensor>,
    #[serde(flatten)]
    pub rates: Rates,
    pub frames: u32,
    pub damaged: u32,
    pub lost: u32,
    pub restarts: u32,
    /// Events that this program was too slow for.
    pub dropped_events: u64,
    pub clock: Option<BoardTime>,
    /// From the sample to the screen.
    pub latency: Option<Percentiles>,
    /// The part of it that is not measured but reckoned: the board's work and the frame on the line.
    pub least_delay_ms: Option<f64>,
    pub recording: Option<Progress>,
    /// What a person should know.
    pub notes: Vec<String>,
}

/// Who the board is.
#[derive(Debug, Serialize)]
pub(super) struct Board {
    arm: String,
    firmware: String,
    boot: u32,
    reset: telemetry::ResetCause,
    last_panic: Option<String>,
}

/// How it is.
#[derive(Debug, Serialize)]
pub(super) struct BoardHealth {
    load_percent: f64,
    longest_tick_ms: f64,
    overruns: u32,
    dropped_frames: u32,
    bus_recoveries: u32,
    saturations: u32,
    actuation: Actuation,
    pressures_kpa: [f64; telemetry::REGULATORS],
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
            pressures_kpa: health.pressures_pa.map(|pressure_pa| f64::from(pressure_pa) / 1e3),
        }
    }
}

/// How a sensor is.
#[derive(Debug, Serialize)]
pub(super) struct Sensor {
    pub state: SensorState,
    pub reason: &'static str,
    pub missed: u16,
}

impl From<SensorHealth> for Sensor {
    fn from(SensorHealth { state, missed }: SensorHealth) -> Self {
        let reason = match state {
            SensorState::Ok => "reads well",
            SensorState::NoResponse => "does not answer, or reads at a rail",
            SensorState::Stuck => "repeats itself while others move",
            SensorState::Invalid => "says what cannot be",
            SensorState::Inconsistent => "contradicts the others",
            SensorState::Timeout => "answers too late",
            SensorState::Intermittent => "comes and goes",
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

/// How fast the board's clock parts from the host's.
#[derive(Debug, Serialize)]
pub(super) struct ClockDrift {
    board_ppm: f64,
    error_ppm: f64,
    seconds: f64,
}

impl From<Drift> for ClockDrift {
    fn from(Drift { board_ppm, error_ppm, seconds }: Drift) -> Self {
        Self { board_ppm, error_ppm, seconds }
    }
}

impl Status {
    /// What the link tells; the rest is for whom it concerns.
    pub fn new(link: LinkState, rates: Rates) -> Self {
        let board = link.hello.map(|hello| Board {
            arm: hello.arm.as_str().to_owned(),
            firmware: hello.firmware.as_str().to_owned(),
            boot: hello.boot,
            reset: hello.reset,
            last_panic: hello.last_panic.map(|said| said.as_str().to_owned()),
        });
        Self {
            port: link.port,
            answers: link.greeted,
            board,
            health: None,
            sensors: Vec::new(),
            rates,
            frames: link.counts.received,
            damaged: link.counts.damaged,
            lost: link.counts.lost,
            restarts: link.restarts,
            dropped_events: 0,
            clock: None,
            latency: None,
            least_delay_ms: None,
            recording: None,
            notes: link.mismatches.iter().map(ToString::to_string).collect(),
        }
    }
}
