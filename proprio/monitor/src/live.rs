//! Rows and status of a live board, from the events of its link.

use std::collections::VecDeque;

use proprio_check::{Finding, SessionCheck};
use proprio_link::status::MessageRates;
use proprio_link::{EventKind, LinkEvent};
use proprio_session::{ClockSync, HostNs, Row, RowAssembler};
use telemetry::{FrameLengths, Health, LINE_BYTES_PER_SECOND, Message, SensorHealth, SensorState, Uncertainty};

use super::feed::BoardTime;
use super::host_replica::HostReplica;
use super::page_row::{ArmSize, ColumnGroup, PageRow};
use super::sweep::Sweep;

/// Time over which rates are measured, ns.
const RATES_NS: u64 = 2_000_000_000;

/// A row, with the time of its sample.
#[derive(Debug)]
pub(super) struct TimedRow {
    pub row: PageRow,
    /// Time of the sample on the host's clock: that of the shortest delay of the last samples, less the known part of it.
    pub sampled: HostNs,
}

/// Numbers of received messages and bytes at a time.
#[derive(Debug, Clone, Copy, Default)]
struct Totals {
    at_ns: u64,
    samples: u64,
    estimates: u64,
    bytes: u64,
}

/// A live board.
pub(super) struct Live<'t> {
    replica: Option<HostReplica<'t>>,
    check: Option<SessionCheck>,
    pub sweep: Sweep,
    assembler: RowAssembler,
    clock: ClockSync,
    /// The board's time 0 on the host's clock, ns.
    zero_ns: Option<u64>,
    pub health: Option<Health>,
    /// The last one, with the contact of later events.
    uncertainty: Option<Uncertainty>,
    /// Regulators of the board's arm.
    regulators: usize,
    /// Pressures that the host has requested last, Pa.
    requested_pa: Vec<u32>,
    totals: Totals,
    totals_before: VecDeque<Totals>,
}

impl<'t> Live<'t> {
    pub fn new(replica: Option<HostReplica<'t>>, check: Option<SessionCheck>) -> Self {
        Self {
            replica,
            check,
            sweep: Sweep::default(),
            assembler: RowAssembler::default(),
            clock: ClockSync::default(),
            zero_ns: None,
            health: None,
            uncertainty: None,
            regulators: 0,
            requested_pa: Vec::new(),
            totals: Totals::default(),
            totals_before: VecDeque::new(),
        }
    }

    /// Takes an event of the link; returns the row that it completes.
    pub fn take(&mut self, event: &LinkEvent) -> Option<TimedRow> {
        match &event.kind {
            EventKind::Bytes(bytes) => self.totals.bytes += bytes.len() as u64,
            EventKind::Message(message) => {
                self.message(message);
                // A `Hello` with another schema is a mismatch, of which the link has its own event.
                let before = self.assembler.message(event.at, message, event.gaps).unwrap_or_default();
                // The estimate of the row before was lost, or the one of this row has arrived.
                let row = before.or_else(|| self.assembler.take_estimated());
                return row.map(|row| self.timed(&row));
            }
            EventKind::Opened(_) => self.assembler.line_opened(),
            EventKind::Restarted | EventKind::Lost(_) | EventKind::Ended(_) => {
                (self.health, self.uncertainty) = (None, None);
                self.sweep.board_lost();
                self.requested_pa.clear();
            }
            EventKind::SetPoints(requested) => self.requested_pa = requested.pressures_pa.to_vec(),
            EventKind::Undecoded(_) | EventKind::Mismatch(_) => {}
        }
        None
    }

    fn message(&mut self, message: &Message) {
        self.sweep.take(message);
        match message {
            Message::Sample(_) => self.totals.samples += 1,
            Message::Estimate(_) => self.totals.estimates += 1,
            Message::Health(health) => self.health = Some(health.clone()),
            Message::Uncertainty(uncertainty) => self.uncertainty = Some(uncertainty.clone()),
            Message::Event(telemetry::Event::Contact(_, mask)) => self.contact(*mask),
            Message::Event(telemetry::Event::Bend(i, state)) => {
                set_state(self.health.as_mut().map(|health| &mut health.bend[..]), *i, *state);
            }
            Message::Event(telemetry::Event::Imu(i, state)) => {
                set_state(self.health.as_mut().map(|health| &mut health.imu[..]), *i, *state);
            }
            Message::Event(telemetry::Event::Condition(segment, conditions)) => {
                let held = self.health.as_mut().and_then(|health| health.conditions.get_mut(usize::from(*segment)));
                if let Some(held) = held {
                    *held = *conditions;
                }
            }
            Message::Hello(hello) => self.regulators = hello.regulators.into(),
            Message::Event(_) | Message::Reply(_) | Message::Table(_) | Message::TableData(_) | Message::Tare(_) => {}
        }
    }

    /// The size of the arm that a message shows; `None` of other messages.
    pub fn size(&self, message: &Message) -> Option<ArmSize> {
        let segments = match message {
            Message::Hello(hello) => usize::from(hello.segments),
            Message::Sample(sample) => sample.imu.len(),
            _ => return None,
        };
        Some(ArmSize { segments, regulators: self.regulators })
    }

    /// The row for the page. The replica runs from a start of the board's estimator until a sample is lost; from then on its
    /// state differs from the board's, and the row has no drift and no innovations until the next start.
    fn timed(&mut self, row: &Row) -> TimedRow {
        let board = row.board.as_ref();
        let segments = board.map_or(0, |board| board.segments);
        let size = ArmSize { segments, regulators: self.regulators };
        let mut page_row = PageRow::new(row.sample.time_us as f64 / 1e6, size);
        // A table with another number of segments is not of this arm.
        let mut replica = self.replica.as_mut().filter(|replica| replica.segments() == segments);
        if let Some(replica) = &mut replica {
            if row.starts {
                replica.start();
            }
            if row.is_comparable() {
                replica.step(&row.sample, &mut page_row);
            }
        }
        if let Some(check) = self.check.as_mut().filter(|_| replica.is_some()) {
            if row.starts {
                check.restart();
            }
            check.update(row);
        }
        self.sweep.update(row, segments);
        // The page shows the board's own estimate.
        let estimate = board.and_then(|board| board.estimate.as_ref());
        page_row.set_estimate(estimate.map_or(&vec![None; segments], |estimate| &estimate.segments));
        if let Some(uncertainty) = &self.uncertainty {
            page_row.set_uncertainty(uncertainty);
        }
        page_row.set_pressures(ColumnGroup::PressureRequested, &self.requested_pa);
        if let Some(health) = &self.health {
            page_row.set_pressures(ColumnGroup::PressureSet, &health.pressures_pa);
        }
        page_row.set_sample(&row.sample);
        let (at, time_us) = board.map_or((HostNs(0), 0), |board| (board.at, board.time_us));
        let delay_ns = self.min_delay_us().map_or(0, |delay_us| u64::from(delay_us) * 1000);
        let sampled = HostNs(self.clock.host_ns(at, time_us).0.saturating_sub(delay_ns));
        self.zero_ns = Some(sampled.0.saturating_sub(time_us.saturating_mul(1000)));
        TimedRow { row: page_row, sampled }
    }

    /// Shortest time from a sample to its arrival, µs, which one-way time stamps cannot show: the latency that the board
    /// reports, and the time of the frame on the line.
    pub fn min_delay_us(&self) -> Option<u32> {
        let health = self.health.as_ref()?;
        let frame_bytes = FrameLengths::of(health.imu.len(), health.pressures_pa.len()).sample;
        Some(health.max_estimate_latency_us.saturating_add(frame_bytes * 1_000_000 / LINE_BYTES_PER_SECOND))
    }

    /// The board's clock relative to the host's.
    pub fn board_time(&self) -> Option<BoardTime> {
        let zero_ms = self.zero_ns? as f64 / 1e6;
        Some(BoardTime { zero_ms, drift: self.clock.drift() })
    }

    /// Takes the begin or end of contact. The next uncertainty has the same, up to a quarter of a second later.
    fn contact(&mut self, mask: u8) {
        let segments = self.uncertainty.iter_mut().flat_map(|uncertainty| &mut uncertainty.segments);
        segments.enumerate().for_each(|(i, segment)| segment.in_contact = mask >> i & 1 == 1);
    }

    /// The findings of the session check since the last start of the board's estimator.
    pub fn findings(&self) -> Vec<Finding> {
        self.check.as_ref().map(SessionCheck::findings).unwrap_or_default()
    }

    /// All sensors, bend sensors first, then IMUs.
    pub fn sensors(&self) -> Vec<SensorHealth> {
        self.health.iter().flat_map(|health| health.bend.iter().chain(&health.imu).copied()).collect()
    }

    /// Begins to count messages from now on, behind those of a history.
    pub fn restart_rates(&mut self) {
        self.totals = Totals::default();
    }

    /// Rates over the last two seconds; called a few times per second.
    pub fn rates(&mut self, now: HostNs) -> MessageRates {
        self.totals.at_ns = now.0;
        while self.totals_before.front().is_some_and(|then| now.0.saturating_sub(then.at_ns) > RATES_NS) {
            self.totals_before.pop_front();
        }
        self.totals_before.push_back(self.totals);
        let (now, then) = (self.totals, self.totals_before.front().copied().unwrap_or_default());
        let seconds = (now.at_ns - then.at_ns) as f64 / 1e9;
        let rate = |count: u64| if seconds > 0.0 { count as f64 / seconds } else { 0.0 };
        MessageRates {
            samples_hz: rate(now.samples - then.samples),
            estimates_hz: rate(now.estimates - then.estimates),
            bytes_per_s: rate(now.bytes - then.bytes),
        }
    }
}

/// Sets the state of a sensor that has changed. The next health has the same, up to a quarter of a second later.
fn set_state(sensors: Option<&mut [SensorHealth]>, i: u8, state: SensorState) {
    if let Some(sensor) = sensors.and_then(|sensors| sensors.get_mut(usize::from(i))) {
        sensor.state = state;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use calibration_tables::ArmFile;
    use estimator_core::Q;
    use telemetry::{Estimate, Sample, TICK_HZ};

    use super::{EventKind, HostNs, HostReplica, LinkEvent, Live, Message, TimedRow};
    use crate::page_row::ColumnGroup;

    /// Ticks from a tare until the replica's estimates are there.
    const TARE_TICKS: u32 = 150;

    /// Segments of the reference arm.
    const SEGMENTS: usize = 6;

    /// A stream of samples, each with its estimate.
    struct Stream<'t> {
        live: Live<'t>,
        gaps: u32,
        tare: u8,
    }

    impl Stream<'_> {
        fn message(&mut self, tick: u32, message: Message) -> Option<TimedRow> {
            let at = HostNs(1_000_000_000_000 + u64::from(tick) * 10_000_000);
            self.live.take(&LinkEvent { at, gaps: self.gaps, kind: EventKind::Message(message) })
        }

        /// Sends a tick; returns the drifts and innovations of its row that have a value.
        fn tick(&mut self, tick: u32) -> usize {
            let bend = [Some(2000); 2 * SEGMENTS].into_iter().collect();
            let imu = [Some([16_384, 0, 0, 0]); SEGMENTS].into_iter().collect();
            let sample = Sample { tick, time_us: u64::from(tick) * 10_000, tare_epoch: self.tare, bend, imu };
            assert!(self.message(tick, Message::Sample(sample)).is_none());
            let estimate = Estimate { tick, segments: [None; SEGMENTS].into_iter().collect() };
            let TimedRow { row, .. } = self.message(tick, Message::Estimate(estimate)).expect("its row");
            let groups = [ColumnGroup::Drift, ColumnGroup::InnovationImu, ColumnGroup::InnovationBend];
            groups.iter().flat_map(|group| row.group(*group)).filter(|value| !value.is_nan()).count()
        }

        fn ticks(&mut self, ticks: std::ops::Range<u32>) -> usize {
            ticks.map(|tick| self.tick(tick)).last().unwrap_or(0)
        }
    }

    #[test]
    fn drift_and_innovations_are_empty_from_a_lost_sample_to_the_next_tare_or_restart() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml");
        let compiled = ArmFile::load(&path).and_then(|file| file.compile::<Q>(TICK_HZ)).expect("the reference table");
        let config = compiled.config();
        let mut stream = Stream { live: Live::new(Some(HostReplica::new(&config)), None), gaps: 0, tare: 0 };
        let all = 3 * SEGMENTS;
        assert_eq!(stream.ticks(0..TARE_TICKS), all);

        // A tick that the board has skipped is no gap.
        assert_eq!(stream.ticks(TARE_TICKS + 1..200), all);

        // Sample 200 is lost.
        stream.gaps += 1;
        assert_eq!((stream.tick(201), stream.ticks(202..500)), (0, 0));

        stream.tare += 1;
        assert_eq!(stream.ticks(500..500 + TARE_TICKS), all);

        stream.gaps += 1;
        assert_eq!(stream.tick(1000), 0);
        stream.gaps += 1;
        stream.tare = 0;
        assert_eq!(stream.ticks(0..TARE_TICKS), all);
    }

    #[test]
    fn a_repeated_sample_makes_no_row() {
        let mut stream = Stream { live: Live::new(None, None), gaps: 0, tare: 0 };
        stream.ticks(0..5);
        let (bend, imu) = ([None; 2 * SEGMENTS].into_iter().collect(), [None; SEGMENTS].into_iter().collect());
        let sample = Sample { tick: 3, time_us: 30_000, tare_epoch: 0, bend, imu };
        let estimate = Estimate { tick: 3, segments: [None; SEGMENTS].into_iter().collect() };
        assert!(stream.message(3, Message::Sample(sample)).is_none());
        assert!(stream.message(3, Message::Estimate(estimate)).is_none());
    }
}
