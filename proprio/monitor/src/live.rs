//! What a link says, as rows and as how the board is.

use std::collections::VecDeque;

use estimator_core::Sample;
use proprio_link::status::Rates;
use proprio_link::{Event, What};
use proprio_session::{BoardClock, HostNs};
use telemetry::{BEND_SENSORS, Estimate, Health, Message, SEGMENTS, SensorHealth, SensorState, Uncertainty};

use super::feed::BoardTime;
use super::row::Row;
use super::shadow::Shadow;

/// Time that rates are of, ns.
const RATES_NS: u64 = 2_000_000_000;
/// Time from one tick to the next, µs.
const TICK_US: u64 = 10_000;
/// Time to send a sample's frame of 98 bytes at 250 000 Bd, µs.
const SAMPLE_FRAME_US: u32 = 3920;

/// A row, and when its sample was taken.
#[derive(Debug)]
pub(super) struct Taken {
    pub row: Row,
    /// By the shortest delay of the last samples, and what is known of that delay.
    pub sampled: HostNs,
}

/// What came until a time.
#[derive(Debug, Clone, Copy, Default)]
struct Totals {
    at_ns: u64,
    samples: u64,
    estimates: u64,
    bytes: u64,
}

/// A live board.
pub(super) struct Live<'t> {
    shadow: Option<Shadow<'t>>,
    /// Whether the shadow has seen every sample since the estimator's start.
    is_shadowed: bool,
    clock: BoardClock,
    /// The board's time 0 on the host's clock, ns.
    zero_ns: Option<u64>,
    /// The row that waits for its estimate, and its tick.
    open: Option<(u32, Taken)>,
    last: Option<Last>,
    /// What is added to the board's time, so that it goes on over a restart, µs.
    base_us: u64,
    restarted: bool,
    pub health: Option<Health>,
    /// The last that came, with the contact that was told since.
    pub uncertainty: Option<Uncertainty>,
    totals: Totals,
    totals_before: VecDeque<Totals>,
}

/// What the sample before was.
struct Last {
    at: HostNs,
    tare: u8,
    time_us: u64,
}

impl<'t> Live<'t> {
    pub fn new(shadow: Option<Shadow<'t>>) -> Self {
        Self {
            shadow,
            is_shadowed: false,
            clock: BoardClock::default(),
            zero_ns: None,
            open: None,
            last: None,
            base_us: 0,
            restarted: false,
            health: None,
            uncertainty: None,
            totals: Totals::default(),
            totals_before: VecDeque::new(),
        }
    }

    /// Takes what happened on the link; gives the row that it completes.
    pub fn take(&mut self, event: &Event) -> Option<Taken> {
        match &event.what {
            What::Bytes(bytes) => self.totals.bytes += bytes.len() as u64,
            What::Message(message) => return self.message(event.at, message),
            What::Restarted => {
                self.restarted = true;
                (self.health, self.uncertainty) = (None, None);
            }
            What::Lost(_) | What::Ended(_) => (self.health, self.uncertainty) = (None, None),
            What::Opened(_) | What::Undecoded(_) | What::Mismatch(_) => {}
        }
        None
    }

    fn message(&mut self, at: HostNs, message: &Message) -> Option<Taken> {
        match message {
            Message::Sample(sample) => {
                self.totals.samples += 1;
                let row = self.sample(at, sample);
                // The estimate of the one before was lost.
                return self.open.replace((sample.tick, row)).map(|(_, taken)| taken);
            }
            Message::Estimate(estimate) => {
                self.totals.estimates += 1;
                return self.estimate(estimate);
            }
            Message::Health(health) => self.health = Some(*health),
            Message::Uncertainty(uncertainty) => self.uncertainty = Some(*uncertainty),
            Message::Event(telemetry::Event::Contact(_, touched)) => self.contact(*touched),
            Message::Event(telemetry::Event::Bend(i, state)) => self.sensor(usize::from(*i), *state),
            Message::Event(telemetry::Event::Imu(i, state)) => self.sensor(BEND_SENSORS + usize::from(*i), *state),
            Message::Hello(_) | Message::Event(_) | Message::Reply(_) => {}
        }
        None
    }

    fn sample(&mut self, at: HostNs, sample: &telemetry::Sample) -> Taken {
        let restarted = std::mem::take(&mut self.restarted);
        let mut starts = true;
        if let Some(last) = &self.last {
            if restarted || self.base_us + sample.time_us < last.time_us {
                let passed_us = (at.0.saturating_sub(last.at.0) / 1000).max(TICK_US);
                self.base_us = (last.time_us + passed_us).saturating_sub(sample.time_us);
                self.is_shadowed = sample.tick == 0;
            } else if sample.tare_epoch == last.tare {
                starts = false;
            } else {
                self.is_shadowed = true;
            }
        } else {
            self.is_shadowed = sample.tick == 0;
        }
        let time_us = self.base_us + sample.time_us;
        self.last = Some(Last { at, tare: sample.tare_epoch, time_us });

        let mut row = Row::new(time_us as f64 / 1e6, SEGMENTS);
        if let Some(shadow) = &mut self.shadow {
            if starts {
                shadow.start();
            }
            if self.is_shadowed {
                shadow.step(&Sample::from(sample), &mut row);
            }
        }
        // The board's own estimate is what is shown.
        row.set_estimate(&[None; SEGMENTS]);
        row.set_sample(&Sample::<SEGMENTS>::from(sample));
        let delay_ns = self.least_delay_us().map_or(0, |delay_us| u64::from(delay_us) * 1000);
        let sampled = HostNs(self.clock.host_ns(at, sample.time_us).0.saturating_sub(delay_ns));
        self.zero_ns = Some(sampled.0.saturating_sub(sample.time_us.saturating_mul(1000)));
        Taken { row, sampled }
    }

    fn estimate(&mut self, estimate: &Estimate) -> Option<Taken> {
        let (_, mut taken) = self.open.take_if(|(tick, _)| *tick == estimate.tick)?;
        taken.row.set_estimate(&estimate.segments);
        Some(taken)
    }

    /// The shortest time from a sample to its arrival, which no comparison of clocks in one direction can tell: what the board
    /// says of its own work, and the time of the frame on the line.
    pub fn least_delay_us(&self) -> Option<u32> {
        self.health.map(|health| health.max_estimate_latency_us.saturating_add(SAMPLE_FRAME_US))
    }

    /// How the board's clock stands to the host's.
    pub fn board_time(&self) -> Option<BoardTime> {
        let zero_ms = self.zero_ns? as f64 / 1e6;
        Some(BoardTime { zero_ms, drift: self.clock.drift().map(Into::into) })
    }

    /// Contact has begun or ended. The next uncertainty says the same, up to a quarter of a second later.
    fn contact(&mut self, touched: [bool; SEGMENTS]) {
        let segments = self.uncertainty.iter_mut().flat_map(|uncertainty| &mut uncertainty.segments);
        segments.zip(touched).for_each(|(segment, touched)| segment.in_contact = touched);
    }

    /// The state of a sensor has changed: bend sensors first, then IMUs. Health says the same, up to a fifth of a second later.
    fn sensor(&mut self, i: usize, state: SensorState) {
        let Some(health) = &mut self.health else { return };
        if let Some(sensor) = health.bend.iter_mut().chain(&mut health.imu).nth(i) {
            sensor.state = state;
        }
    }

    /// All sensors, bend sensors first, then IMUs.
    pub fn sensors(&self) -> Vec<SensorHealth> {
        self.health.iter().flat_map(|health| health.bend.iter().chain(&health.imu).copied()).collect()
    }

    /// What came a second, over the last two; asked for a few times a second.
    pub fn rates(&mut self, now: HostNs) -> Rates {
        self.totals.at_ns = now.0;
        while self.totals_before.front().is_some_and(|then| now.0.saturating_sub(then.at_ns) > RATES_NS) {
            self.totals_before.pop_front();
        }
        self.totals_before.push_back(self.totals);
        let (now, then) = (self.totals, self.totals_before.front().copied().unwrap_or_default());
        let seconds = (now.at_ns - then.at_ns) as f64 / 1e9;
        let rate = |count: u64| if seconds > 0.0 { count as f64 / seconds } else { 0.0 };
        Rates {
            samples_hz: rate(now.samples - then.samples),
            estimates_hz: rate(now.estimates - then.estimates),
            bytes_per_s: rate(now.bytes - then.bytes),
        }
    }
}
