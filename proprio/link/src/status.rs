//! How a board is, as far as can be seen within seconds.

use std::time::{Duration, Instant};

use proprio_session::{Ellipse, is_version_0_1};
use serde::Serialize;
use telemetry::{Event, Health, Hello, Message, SEGMENTS, TICK_HZ, Uncertainty};

use crate::{Link, LinkError, Mismatch, Subscription, What};

/// How long a board may be silent, s.
const PATIENCE_S: u64 = 10;
/// Rates are those of at least so long, s.
const RATES_S: f64 = 1.0;
/// A board that has just started is looked at until its first tare is over, or so long: its IMUs come up slowly.
const SETTLING: Duration = Duration::from_secs(3);
/// From the begin of a tare until the arm is known as well as it will be and the board has said so.
const TARE_TICKS: u32 = 150;

/// How a board is.
#[derive(Debug, Serialize)]
pub struct Status {
    /// Name of the line.
    pub port: String,
    /// Version of this program.
    pub proprio: &'static str,
    /// Who the board is and how it came up.
    pub hello: Hello,
    /// Its counters and its sensors' states.
    pub health: Health,
    /// How well it knows the arm's shape, where it has said so.
    pub shape: Option<KnownShape>,
    /// What came a second.
    pub rates: Rates,
    /// What was received.
    pub received: Received,
    /// Whether the board answers requests.
    pub answers: bool,
    /// Whether its table is the one that was given.
    pub table_matches: Option<bool>,
    /// In what board and host differ.
    pub mismatches: Vec<String>,
}

/// How well a board knows the arm's shape.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct KnownShape {
    /// Standard deviation of each bend angle, degrees, from the base; `None`: not known.
    pub theta_sd_deg: [Option<f64>; SEGMENTS],
    /// Where the tip is about its estimate; `None`: not known.
    pub tip: Option<Ellipse>,
    /// Whether something touches each segment.
    pub touched: [bool; SEGMENTS],
}

impl From<&Uncertainty> for KnownShape {
    fn from(Uncertainty { segments, .. }: &Uncertainty) -> Self {
        let [.., tip] = segments;
        Self {
            theta_sd_deg: segments.map(|segment| segment.theta_rad2().map(|variance| variance.sqrt().to_degrees())),
            tip: tip.end_m2().map(Ellipse::of),
            touched: segments.map(|segment| segment.in_contact),
        }
    }
}

/// What came a second.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Rates {
    /// Samples, Hz.
    pub samples_hz: f64,
    /// Estimates, Hz.
    pub estimates_hz: f64,
    /// Bytes a second.
    pub bytes_per_s: f64,
}

/// Frames since the line was opened.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Received {
    /// That came whole.
    pub frames: u32,
    /// That came damaged.
    pub damaged: u32,
    /// That were sent and never came.
    pub lost: u32,
}

/// What was seen so far.
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
    /// First and last tick that the rates are of.
    ticks: Option<(u32, u32)>,
}

impl Status {
    /// Listens until the board has said who and how it is. `table_given`: the link knows the table that it should have.
    ///
    /// # Errors
    /// [`LinkError::Silent`] and [`LinkError::Ended`].
    pub fn of(link: &Link, events: &Subscription, table_given: bool) -> Result<Self, LinkError> {
        let (start, mut seen) = (Instant::now(), Seen::default());
        loop {
            match events.next(Duration::from_millis(50)).map(|event| event.what) {
                Some(What::Ended(reason)) => return Err(LinkError::Ended(reason)),
                Some(What::Bytes(bytes)) if seen.ticks.is_some() => seen.bytes += bytes.len() as u64,
                Some(What::Message(message)) => seen.take(&message),
                Some(What::Restarted) => seen = Seen::default(),
                _ => {}
            }
            let state = link.state();
            if let (Some(hello), Some(health), Some(rates)) = (state.hello, seen.health, seen.rates()) {
                let is_comparable = !is_version_0_1(&hello.firmware);
                let differs = |mismatch: &Mismatch| matches!(mismatch, Mismatch::Table { .. });
                return Ok(Self {
                    port: state.port.unwrap_or_default(),
                    proprio: env!("CARGO_PKG_VERSION"),
                    hello,
                    health,
                    shape: seen.shape,
                    rates,
                    received: Received {
                        frames: state.counts.received,
                        damaged: state.counts.damaged,
                        lost: state.counts.lost,
                    },
                    answers: state.greeted,
                    table_matches: (table_given && is_comparable).then(|| !state.mismatches.iter().any(differs)),
                    mismatches: state.mismatches.iter().map(ToString::to_string).collect(),
                });
            }
            if start.elapsed().as_secs() >= PATIENCE_S && seen.health.is_none() {
                return Err(silent(link));
            }
            // An emulated board may be slow, and takes its time to settle.
            if start.elapsed().as_secs() >= 3 * PATIENCE_S {
                return Err(silent(link));
            }
        }
    }
}

fn silent(link: &Link) -> LinkError {
    let state = link.state();
    if let Some(mismatch) = state.mismatches.first() {
        return LinkError::Ended(mismatch.to_string());
    }
    LinkError::Silent {
        port: state.port.unwrap_or_else(|| "the line".to_owned()),
        seconds: PATIENCE_S,
        received: state.counts.received,
        damaged: state.counts.damaged,
    }
}

impl Seen {
    fn take(&mut self, message: &Message) {
        match message {
            Message::Health(health) => {
                self.health = Some(*health);
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
            Message::Event(Event::Contact(_, touched)) => {
                self.shape = self.shape.map(|shape| KnownShape { touched: *touched, ..shape });
            }
            _ => {}
        }
    }

    fn pass(&mut self, tick: u32) {
        self.ticks = Some((self.ticks.map_or(tick, |(first, _)| first), tick));
    }

    /// By the board's clock, once it has settled and enough has come.
    fn rates(&self) -> Option<Rates> {
        let (first, last) = self.ticks?;
        let is_tared = self.tared.is_some_and(|tick| last.saturating_sub(tick) >= TARE_TICKS);
        let settled = is_tared || self.healthy_since?.elapsed() >= SETTLING;
        let seconds = f64::from(last.saturating_sub(first)) / TICK_HZ;
        (settled && seconds >= RATES_S).then(|| Rates {
            samples_hz: f64::from(self.samples) / seconds,
            estimates_hz: f64::from(self.estimates) / seconds,
            bytes_per_s: self.bytes as f64 / seconds,
        })
    }
}
