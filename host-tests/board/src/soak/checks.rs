//! Checks of the board's stream: ticks, counters, estimates against the host's, and the tip against the truth.

use std::collections::VecDeque;

use estimator_core::{ArmConfig, Q};
use telemetry::{Estimate, Event, Health, Message, Sample, SegmentUncertainty, SensorHealth, Uncertainty};

use super::finding::{Finding, Invariant};
use super::sensors::Reported;
use super::truth::TruthLog;
use crate::replay::{Replayed, Replica};

/// Results of the host that are kept for the board's, ticks.
const KEPT: usize = 100;
/// Stated standard deviations within which the tip is.
const DEVIATIONS: f64 = 3.0;

/// What the faults that are there explain.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Excuse {
    /// Messages do not arrive.
    pub lost: bool,
    /// Ticks are held up.
    pub held_up: bool,
    /// An IMU is frozen, and need not be noticed yet.
    pub unnoticed: bool,
}

/// The tip since the last question.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TipFigures {
    /// Largest distance from the truth, mm.
    pub worst_mm: f64,
    /// The same in stated standard deviations.
    pub worst_deviations: f64,
    /// Number of comparisons with the stated deviation, and of those that were flagged.
    pub compared: u64,
    pub flagged: u64,
}

/// A tip that waits for flags of its own tick, which are sent after it.
struct Compared {
    time_s: f64,
    error_mm: f64,
    deviation_mm: f64,
    is_flagged: bool,
}

/// The stream since the last restart.
pub struct Checks<'t> {
    config: &'t ArmConfig<'t, Q>,
    replica: Replica<'t>,
    /// True if the replica has had every sample since its start.
    is_replica: bool,
    /// Tick of the tare at which the comparison was resumed last.
    resumed_at: Option<u32>,
    replayed: VecDeque<Replayed>,
    last: Option<Sample>,
    health: Option<Health>,
    reported: Reported,
    errors_mm: VecDeque<(u32, f64)>,
    /// Distance of the true tip from that of the straight arm at the last tare, mm.
    pub tare_offset_mm: f64,
    waiting: Vec<Compared>,
    tip: TipFigures,
    /// Number of estimates that were compared with the host's.
    pub replays: u64,
    /// Time of the last sample, s.
    pub sampled_s: f64,
    findings: Vec<Finding>,
}

impl<'t> Checks<'t> {
    /// Of a board with this table, with power just come up.
    pub fn new(config: &'t ArmConfig<'t, Q>) -> Self {
        Self {
            config,
            replica: Replica::new(config),
            is_replica: false,
            resumed_at: None,
            replayed: VecDeque::new(),
            last: None,
            health: None,
            reported: Reported::new(),
            errors_mm: VecDeque::new(),
            tare_offset_mm: 0.0,
            waiting: Vec::new(),
            tip: TipFigures::default(),
            replays: 0,
            sampled_s: 0.0,
            findings: Vec::new(),
        }
    }

    /// The board has restarted.
    pub fn restart(&mut self) {
        *self = Self {
            tip: self.tip,
            replays: self.replays,
            findings: std::mem::take(&mut self.findings),
            sampled_s: self.sampled_s,
            ..Self::new(self.config)
        };
    }

    /// Takes the findings since the last call.
    pub fn take_findings(&mut self) -> Vec<Finding> {
        std::mem::take(&mut self.findings)
    }

    /// Takes the tip's figures since the last call.
    pub fn take_tip(&mut self) -> TipFigures {
        std::mem::take(&mut self.tip)
    }

    /// True if every sensor is Ok, and the tip's last error within a limit.
    pub fn is_recovered(&self, limit_mm: f64) -> bool {
        self.reported.are_ok() && self.errors_mm.back().is_some_and(|(_, error_mm)| *error_mm <= limit_mm)
    }

    /// Checks a message.
    pub fn message(&mut self, message: &Message, time_s: f64, truth: &TruthLog, excuse: Excuse) {
        match message {
            Message::Sample(sample) => {
                if self.last.as_ref().is_some_and(|last| last.tare_epoch != sample.tare_epoch) {
                    self.tare_offset_mm = truth.offset_mm(sample.tick);
                }
                self.sample(sample, time_s, excuse);
            }
            Message::Estimate(estimate) => self.estimate(estimate, time_s, truth),
            Message::Uncertainty(uncertainty) => self.uncertainty(uncertainty, time_s, excuse),
            Message::Health(health) => self.health(health, time_s, excuse),
            Message::Event(event) => self.event(*event, time_s),
            _ => {}
        }
    }

    fn sample(&mut self, sample: &Sample, time_s: f64, excuse: Excuse) {
        self.sampled_s = time_s;
        let (expected, epoch) = self.last.as_ref().map_or((0, 0), |last| (last.tick + 1, last.tare_epoch));
        let is_next = sample.tick == expected;
        if !is_next && !excuse.lost && !excuse.held_up {
            let figure = format!("tick {} comes in place of {expected}", sample.tick);
            self.find(Invariant::EveryTick, time_s, figure);
        }
        // A loss pauses the comparison until the estimator restarts, at a tare or a boot.
        let was_replica = self.is_replica;
        self.is_replica = is_next && (was_replica || self.last.is_none() || sample.tare_epoch != epoch);
        if self.is_replica && !was_replica {
            self.resumed_at = self.last.as_ref().map(|_| sample.tick);
        }
        if self.is_replica {
            self.replayed.push_back(self.replica.update(sample));
            if self.replayed.len() > KEPT {
                self.replayed.pop_front();
            }
        } else {
            self.replayed.clear();
            self.replica = Replica::new(self.config);
        }
        self.last = Some(sample.clone());
    }

    /// The host's results of a tick.
    fn replayed(&self, tick: u32) -> Option<&Replayed> {
        self.replayed.iter().rev().find(|replayed| replayed.estimate.tick == tick)
    }

    fn estimate(&mut self, estimate: &Estimate, time_s: f64, truth: &TruthLog) {
        if let Some(expected) = self.replayed(estimate.tick) {
            if expected.estimate != *estimate {
                let figure = format!("the board's {estimate:?}, the host's {:?}", expected.estimate);
                self.find(Invariant::Replay, time_s, figure);
            }
            self.replays += 1;
        }
        let is_tared = self.last.as_ref().is_some_and(|last| last.tare_epoch > 0);
        let bend = self.last.as_ref().map_or(&[][..], |sample| &sample.bend);
        let is_bend_read = |i: usize| bend.iter().skip(2 * i).take(2).any(Option::is_some);
        let unknown =
            (0..).zip(&estimate.segments).filter(|(i, segment)| segment.is_none() && is_bend_read(*i)).count();
        if is_tared && unknown > 0 {
            self.find(Invariant::Known, time_s, format!("{unknown} segments are not known in tick {}", estimate.tick));
        }
        let Some((tip, true_m)) = estimate.segments.last().copied().flatten().zip(truth.tip_m(estimate.tick)) else {
            return;
        };
        let [x_m, y_m] = tip.end.map(|bits| Q::from_bits(bits).to_f64());
        let error_mm = 1e3 * (x_m - true_m[0]).hypot(y_m - true_m[1]);
        if is_tared {
            self.tip.worst_mm = self.tip.worst_mm.max(error_mm);
        }
        self.errors_mm.push_back((estimate.tick, error_mm));
        if self.errors_mm.len() > KEPT {
            self.errors_mm.pop_front();
        }
    }

    fn uncertainty(&mut self, uncertainty: &Uncertainty, time_s: f64, excuse: Excuse) {
        if let Some(expected) = self.replayed(uncertainty.tick)
            && expected.uncertainty != *uncertainty
        {
            let figure = format!("the board's {uncertainty:?}, the host's {:?}", expected.uncertainty);
            self.find(Invariant::Replay, time_s, figure);
        }
        if excuse.unnoticed {
            return;
        }
        let Some((_, error_mm)) = self.errors_mm.iter().rev().find(|(tick, _)| *tick == uncertainty.tick) else {
            return;
        };
        let Some([xx, xy, yy]) = uncertainty.segments.last().and_then(SegmentUncertainty::end_m2) else { return };
        // Long half-axis of the ellipse.
        let variance_m2 = f64::midpoint(xx, yy) + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        let deviation_mm = 1e3 * variance_m2.max(0.0).sqrt();
        let is_flagged = self.reported.are_flagged();
        self.waiting.push(Compared { time_s, error_mm: *error_mm, deviation_mm, is_flagged });
    }

    /// Compares the tips whose flags have arrived, too.
    pub fn compare_tips(&mut self) {
        let are_flagged = self.reported.are_flagged();
        for Compared { time_s, error_mm, deviation_mm, is_flagged } in std::mem::take(&mut self.waiting) {
            let deviations = error_mm / deviation_mm;
            let is_flagged = is_flagged || are_flagged;
            self.tip.worst_deviations = self.tip.worst_deviations.max(deviations);
            self.tip.compared += 1;
            self.tip.flagged += u64::from(is_flagged);
            if deviations > DEVIATIONS && !is_flagged {
                let figure = format!(
                    "{error_mm:.1} mm off, {deviations:.1} × the stated {deviation_mm:.1} mm, not flagged; last tare with \
                     the tip {:.1} mm from straight",
                    self.tare_offset_mm
                );
                self.findings.push(Finding { invariant: Invariant::Tip, time_s, figure, size: deviations });
            }
        }
    }

    fn health(&mut self, health: &Health, time_s: f64, excuse: Excuse) {
        self.reported.health(health);
        let before = self.health.replace(health.clone());
        let Some(before) = before else { return };
        for (name, before, now) in
            counters(&before).zip(counters(health)).map(|((name, before), (_, now))| (name, before, now))
        {
            if now < before {
                self.find(Invariant::Counters, time_s, format!("{name} went from {before} to {now}"));
            }
        }
        if health.overruns > before.overruns && !excuse.held_up {
            let figure = format!("{} overruns more", health.overruns - before.overruns);
            self.find(Invariant::Overruns, time_s, figure);
        }
    }

    fn event(&mut self, event: Event, time_s: f64) {
        self.reported.event(event);
        if let Event::Contact(tick, mask) = event
            && let Some(expected) = self.replayed(tick)
            && expected.contact != Some(event)
            // The board's contact before the tare is not known to a host that is resumed with it.
            && !(self.resumed_at == Some(tick) && expected.contact_mask == mask)
        {
            let figure = format!("the board's {event:?}, the host's {:?}", expected.contact);
            self.find(Invariant::Replay, time_s, figure);
        }
    }

    fn find(&mut self, invariant: Invariant, time_s: f64, figure: String) {
        self.findings.push(Finding::new(invariant, time_s, figure));
    }
}

/// The counters of a health message, by name.
fn counters(health: &Health) -> impl Iterator<Item = (&'static str, u32)> {
    let missed = |name: &'static str| move |sensor: &SensorHealth| (name, u32::from(sensor.missed));
    let bend: Vec<_> = health.bend.iter().map(missed("missed of a bend sensor")).collect();
    let imu: Vec<_> = health.imu.iter().map(missed("missed of an IMU")).collect();
    [
        ("tick", health.tick),
        ("overruns", health.overruns),
        ("stale_scans", health.stale_scans),
        ("dropped_frames", health.dropped_frames),
        ("damaged_frames", health.damaged_frames),
        ("unknown_frames", health.unknown_frames),
        ("bus_recoveries", health.bus_recoveries),
        ("saturations", health.saturations),
    ]
    .into_iter()
    .chain(bend)
    .chain(imu)
}
