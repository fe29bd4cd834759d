//! Status of a board, measured within seconds.

use std::time::{Duration, Instant};

use proprio_session::{Ellipse, is_version_0_1};
use serde::{Deserialize, Serialize};
use telemetry::{Event, Health, Hello, Message, SegmentUncertainty, TICK_HZ, Uncertainty};

use crate::{EventKind, Link, LinkError, Mismatch, Subscription};

/// Longest silence of a board, s.
pub const TIMEOUT_S: u64 = 10;
/// Shortest time over which rates are measured, s.
const RATES_S: f64 = 1.0;
/// Longest wait for the first tare of a board that has just started: its IMUs start slowly.
const SETTLING: Duration = Duration::from_secs(3);
/// Ticks from the begin of a tare until the uncertainty has settled and the board has sent it.
const TARE_TICKS: u32 = 150;

/// Status of a board.
#[derive(Debug, Serialize, Deserialize)]
pub struct Status {
    /// Name of the line.
    pub port: String,
    /// Version of this program.
    pub proprio: String,
    /// Its identity, and the cause of its last reset.
    pub hello: Hello,
    /// Its counters and its sensors' states.
    pub health: Health,
    /// Uncertainty of the arm's shape, where the board has sent one.
    pub shape: Option<KnownShape>,
    /// Rates of the received messages.
    pub rates: MessageRates,
    /// Numbers of received frames.
    pub received: FrameCounts,
    /// True where the board answers requests.
    pub answers: bool,
    /// True where its table is the given one; `None` where that is not known.
    pub table_matches: Option<bool>,
    /// Differences between board and host.
    pub mismatches: Vec<String>,
}

/// Uncertainty of the arm's shape on a board, and contact.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct KnownShape {
    /// Standard deviation of each bend angle, degrees, from the base; `None`: not known.
    pub theta_sd_deg: Vec<Option<f64>>,
    /// 95 % ellipse of the tip; `None`: not known.
    pub tip: Option<Ellipse>,
    /// Contact of each segment.
    pub touched: Vec<bool>,
}

impl From<&Uncertainty> for KnownShape {
    fn from(Uncertainty { segments, .. }: &Uncertainty) -> Self {
        let deviation_deg = |variance_rad2: f64| variance_rad2.sqrt().to_degrees();
        Self {
            theta_sd_deg: segments.iter().map(|segment| segment.theta_rad2().map(deviation_deg)).collect(),
            tip: segments.last().and_then(SegmentUncertainty::end_m2).map(Ellipse::of),
            touched: segments.iter().map(|segment| segment.in_contact).collect(),
        }
    }
}

/// Rates of the received messages.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct MessageRates {
    /// Samples, Hz.
    pub samples_hz: f64,
    /// Estimates, Hz.
    pub estimates_hz: f64,
    /// Bytes per second.
    pub bytes_per_s: f64,
}

/// Numbers of frames since the line was opened.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct FrameCounts {
    /// Frames that arrived undamaged.
    pub frames: u32,
    /// Frames that arrived damaged.
    pub damaged: u32,
    /// Frames that were sent and did not arrive.
    pub lost: u32,
}

/// The messages received so far.
#[derive(Default)]
struct Seen {
    health: Option<Health>,
    shape: Option<KnownShape>,
    healthy_since: Option<Instant>,
    /// Tick of the first sample since a tare.
    tared: Option<u32>,
    samples: u32,
    estimates: u32,
    bytes: u64,
    /// First and last tick of the rates.
    ticks: Option<(u32, u32)>,
}

impl Status {
    /// Receives until the board has sent its identity and its health. `table_given`: the link compares the board's table.
    ///
    /// # Errors
    /// [`LinkError::Silent`] and [`LinkError::Ended`].
    pub fn of(link: &Link, events: &Subscription, table_given: bool) -> Result<Self, LinkError> {
        let (start, mut seen) = (Instant::now(), Seen::default());
        loop {
            match events.next(Duration::from_millis(50)).map(|event| event.kind) {
                Some(EventKind::Ended(reason)) => return Err(LinkError::Ended(reason)),
                Some(EventKind::Bytes(bytes)) if seen.ticks.is_some() => seen.bytes += bytes.len() as u64,
                Some(EventKind::Message(message)) => seen.take(&message),
                Some(EventKind::Restarted) => seen = Seen::default(),
                _ => {}
            }
            let state = link.state();
            if let (Some(hello), Some(health), Some(rates)) = (state.hello, &seen.health, seen.rates()) {
                let is_comparable = !is_version_0_1(&hello.firmware);
                return Ok(Self {
                    port: state.port.unwrap_or_default(),
                    proprio: env!("CARGO_PKG_VERSION").to_owned(),
                    hello,
                    health: health.clone(),
                    shape: seen.shape,
                    rates,
                    received: FrameCounts {
                        frames: state.counts.received,
                        damaged: state.counts.damaged,
                        lost: state.counts.lost,
                    },
                    answers: state.is_connected,
                    table_matches: (table_given && is_comparable)
                        .then(|| !state.mismatches.iter().any(Mismatch::is_table)),
                    mismatches: state.mismatches.iter().map(ToString::to_string).collect(),
                });
            }
            if start.elapsed().as_secs() >= TIMEOUT_S && seen.health.is_none() {
                return Err(link.silent(Duration::from_secs(TIMEOUT_S)));
            }
            // An emulated board may be slow and settle late.
            if start.elapsed().as_secs() >= 3 * TIMEOUT_S {
                return Err(link.silent(Duration::from_secs(TIMEOUT_S)));
            }
        }
    }
}

impl Seen {
    fn take(&mut self, message: &Message) {
        match message {
            Message::Health(health) => {
                self.health = Some(health.clone());
                self.healthy_since.get_or_insert_with(Instant::now);
                self.pass(health.tick);
            }
            Message::Sample(sample) => {
                if sample.tare_epoch > 0 {
                    self.tared.get_or_insert(sample.tick);
                }
                self.samples += u32::from(self.ticks.is_some());
                self.pass(sample.tick);
            }
            Message::Estimate(_) => self.estimates += u32::from(self.ticks.is_some()),
            Message::Uncertainty(uncertainty) => self.shape = Some(uncertainty.into()),
            Message::Event(Event::Contact(_, mask)) => {
                let touched = self.shape.iter_mut().flat_map(|shape| &mut shape.touched);
                touched.enumerate().for_each(|(i, touched)| *touched = mask >> i & 1 == 1);
            }
            _ => {}
        }
    }

    fn pass(&mut self, tick: u32) {
        self.ticks = Some((self.ticks.map_or(tick, |(first, _)| first), tick));
    }

    /// The rates by the board's clock; `None` before it has settled and enough has arrived.
    fn rates(&self) -> Option<MessageRates> {
        let (first, last) = self.ticks?;
        let is_tared = self.tared.is_some_and(|tick| last.saturating_sub(tick) >= TARE_TICKS);
        let settled = is_tared || self.healthy_since?.elapsed() >= SETTLING;
        let seconds = f64::from(last.saturating_sub(first)) / TICK_HZ;
        (settled && seconds >= RATES_S).then(|| MessageRates {
            samples_hz: f64::from(self.samples) / seconds,
            estimates_hz: f64::from(self.estimates) / seconds,
            bytes_per_s: self.bytes as f64 / seconds,
        })
    }
}
