//! Readings that are repeated while the arm moves, and catch up: a logger that hangs, IMUs whose last reading is taken again.
//!
//! An arm at rest repeats its readings, too. Of all sensors they cannot be equal between two rows in which the arm turns, and an
//! arm at rest does not begin with its largest step. Those of an IMU are compared with the bend sensors.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::Phase;

use super::finding::{Finding, Kind, Rows, Source};
use super::frame::{Frame, wrapped};

/// Least step from row to row of an arm that moves, deg.
const MOVES: f64 = 1.0;
/// Least step that catches up, deg, as a multiple of the next one, and least number of repeats before it.
const CATCHES_UP: f64 = 3.0;
const STEPS: f64 = 2.5;
const REPEATS: u64 = 3;
/// Least turn by the bend sensors during an IMU's repeats, deg, and shares of it by which the IMU catches up: it turns on until it
/// is read again. A failed reading, which is written as 0, is further off.
const TURN: f64 = 2.0;
const SHARES: std::ops::RangeInclusive<f64> = 0.5..=3.0;
/// Least age of the last repeat, s: one that is less old hardly matters.
const AGE_S: f64 = 0.08;
/// Least number of readings of a row, and of repeats of a finding.
const READINGS: usize = 4;
const LEAST: u64 = 5;
/// Probability below which no readings are equal by chance, those that change being as many as in the steps before and after.
const CHANCE: f64 = 1e-7;

/// Repeats of all readings.
#[derive(Debug, Clone, Copy, Default)]
struct Logger {
    /// Largest turn of an IMU in the last row that is no repeat, deg.
    step: f64,
    /// Time of that row, s.
    from_s: f64,
    run: Rows,
    /// Probability of that row's readings to be equal to those of the row before by chance.
    chance: f64,
    /// Repeats that have ended, and the step after them: they are wrong if the next step is smaller.
    ended: Option<(Rows, f64)>,
    held: Rows,
}

/// Repeats of one IMU's reading.
#[derive(Debug, Clone, Copy, Default)]
struct Imu {
    value: Option<Phase>,
    /// Heading by the IMU and by the bend sensors at the first of the equal readings, deg.
    from: [f64; 2],
    from_s: f64,
    /// Turn by the bend sensors since then, deg.
    turn: f64,
    run: Rows,
    held: Rows,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Held {
    rows: u64,
    counts: [[Option<u16>; 2]; MAX_SEGMENTS],
    headings: [f64; MAX_SEGMENTS],
    logger: Logger,
    imus: [Imu; MAX_SEGMENTS],
}

impl Held {
    pub fn new() -> Self {
        Self {
            rows: 0,
            counts: [[None; 2]; MAX_SEGMENTS],
            headings: [f64::NAN; MAX_SEGMENTS],
            logger: Logger::default(),
            imus: [Imu::default(); MAX_SEGMENTS],
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        self.rows += 1;
        let turns = frame.heading.iter().zip(&self.headings).map(|(to, from)| (to - from).abs());
        let step = turns.filter(|turn| !turn.is_nan()).fold(0.0, f64::max);
        let is_repeated = self.is_repeated(frame);
        self.logger.update(frame, is_repeated, step, self.chance(frame));
        for (i, imu) in self.imus.iter_mut().enumerate() {
            imu.update(frame, i);
        }
        (self.counts, self.headings) = (frame.counts, frame.heading);
    }

    /// True where all readings are those of the row before.
    fn is_repeated(&self, frame: &Frame) -> bool {
        let read = frame.counts.iter().flatten().flatten().count();
        let headings = frame.heading.iter().filter(|heading| !heading.is_nan()).count();
        let are_equal = frame.heading.iter().zip(&self.headings).all(|(now, last)| now.to_bits() == last.to_bits());
        !frame.starts && headings > 0 && read + headings >= READINGS && are_equal && frame.counts == self.counts
    }

    /// Probability that all readings are equal by chance where as many of them change as from the row before: those of an arm that
    /// moves, and noise.
    fn chance(&self, frame: &Frame) -> f64 {
        let counts = frame.counts.as_flattened().iter().zip(self.counts.as_flattened());
        let counts = counts.filter_map(|(now, last)| Some((*now)? != (*last)?));
        let headings = frame.heading.iter().zip(&self.headings).filter(|(now, last)| !(*now - *last).is_nan());
        let changes = counts.chain(headings.map(|(now, last)| now.to_bits() != last.to_bits()));
        let (changed, read) = changes.fold((0, 0), |(changed, read), is| (changed + i32::from(is), read + 1));
        (1.0 - f64::from(changed) / f64::from(read.max(1))).powi(read)
    }

    pub fn finish(&mut self, findings: &mut Vec<Finding>) {
        self.logger.end();
        let kind = Kind::Held;
        let figure = |rows: &Rows| 100.0 * rows.count as f64 / self.rows as f64;
        let held = self.logger.held;
        if held.count >= LEAST {
            // Steps that catch up are those of no other sensor.
            findings.retain(|finding| finding.kind != Kind::Unrelated);
            findings.push(Finding { sensor: Source::AllSensors, rows: held, kind, figure: figure(&held) });
            return;
        }
        let read = self.imus.iter().filter(|imu| imu.value.is_some()).count();
        let held: Vec<(usize, Rows)> = (1..)
            .zip(&self.imus)
            .filter(|(_, imu)| imu.held.count >= LEAST)
            .map(|(segment, imu)| (segment, imu.held))
            .collect();
        // Those near the base turn too little for some of their repeats.
        if held.len() > 1 && 2 * held.len() >= read {
            let rows = held.iter().map(|(_, rows)| *rows).max_by_key(|rows| rows.count).unwrap_or_default();
            // All at once are not each its own driver's, and steps that catch up are not those of the bend sensors.
            let is_same = |finding: &Finding| {
                matches!(finding.kind, Kind::Frozen | Kind::Unrelated) && matches!(finding.sensor, Source::Imu { .. })
            };
            findings.retain(|finding| !is_same(finding));
            findings.push(Finding { sensor: Source::AllImus, rows, kind, figure: figure(&rows) });
            return;
        }
        for (segment, rows) in held {
            let sensor = Source::Imu { segment };
            if !findings.iter().any(|finding| finding.sensor == sensor) {
                findings.push(Finding { sensor, rows, kind, figure: figure(&rows) });
            }
        }
    }
}

impl Logger {
    fn update(&mut self, frame: &Frame, is_repeated: bool, step: f64, chance: f64) {
        if frame.starts {
            *self = Self { held: self.held, ..Self::default() };
            return;
        }
        if is_repeated {
            self.run.add(frame);
            return;
        }
        // Repeats after the step are a step of 0.
        let next = if self.run.count > 0 { 0.0 } else { step };
        if let Some((rows, caught_up)) = self.ended.take()
            && caught_up > STEPS * next
        {
            self.held.append(&rows);
        }
        let run = std::mem::take(&mut self.run);
        let is_old = run.count > 0 && run.to_s - self.from_s >= AGE_S;
        // More repeats may be a rest, in which readings without noise do not change.
        let is_no_chance = (1..REPEATS).contains(&run.count) && self.chance.max(chance) < CHANCE;
        if is_no_chance || is_old && self.step.min(step) >= MOVES {
            self.held.append(&run);
        } else if is_old && run.count >= REPEATS && step >= CATCHES_UP {
            self.ended = Some((run, step));
        }
        (self.step, self.from_s, self.chance) = (step, frame.time_s, chance);
    }

    /// Ends the repeats at the end of the session, from where the arm did not stop.
    fn end(&mut self) {
        if self.run.count > 0 && self.step >= MOVES {
            self.held.append(&std::mem::take(&mut self.run));
        }
    }
}

impl Imu {
    fn update(&mut self, frame: &Frame, i: usize) {
        let Some(value) = frame.headings[i] else { return };
        let now = [frame.heading[i], frame.bend_heading[i]];
        if self.value == Some(value) && !frame.starts {
            self.turn = now[1] - self.from[1];
            self.run.add(frame);
            return;
        }
        let caught_up = wrapped(now[0] - self.from[0]);
        let is_old = self.run.count > 0 && self.run.to_s - self.from_s >= AGE_S;
        let share = caught_up / self.turn;
        if is_old && self.turn.abs() >= TURN && SHARES.contains(&share) {
            self.held.append(&self.run);
        }
        *self = Self {
            value: Some(value),
            from: now,
            from_s: frame.time_s,
            turn: 0.0,
            run: Rows::default(),
            held: self.held,
        };
    }
}
