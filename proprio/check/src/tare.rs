//! A tare in which the arm is bent or moves.

use calibration_tables::{ArmFile, MAX_SEGMENTS};

use super::finding::{Finding, Kind, Rows, Source, is_bend_blamed, is_imu_blamed};
use super::frame::{Frame, difference, wrapped};

/// Limit of a segment's bend angle against the reference pose, deg.
const BENT: f64 = 12.0;
/// Range of a heading within a tare from which on the arm moved in it, degrees.
pub const TARE_MOVES_DEG: f64 = 3.0;

/// Begin of a session without a tare, s, and limit of the angle between an IMU and its bend sensors there, deg.
const ABSOLUTE_S: f64 = 1.0;
const NOT_ABSOLUTE: f64 = 30.0;

/// Readings during the tare.
#[derive(Debug, Clone, Copy)]
struct Segment {
    sum: f64,
    count: f64,
    first_heading: f64,
    range: [f64; 2],
}

const EMPTY: Segment = Segment { sum: 0.0, count: 0.0, first_heading: f64::NAN, range: [0.0; 2] };

/// Bend angles of the reference pose, deg.
pub(super) fn reference_angles(table: &ArmFile) -> [f64; MAX_SEGMENTS] {
    let mut headings = [0.0; MAX_SEGMENTS];
    headings.iter_mut().zip(&table.tare.heading_deg).for_each(|(heading, given)| *heading = *given);
    std::array::from_fn(|i| difference(&headings, i))
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct Tare {
    seconds: f64,
    reference: [f64; MAX_SEGMENTS],
    ends_s: f64,
    rows: Rows,
    segments: [Segment; MAX_SEGMENTS],
    /// With `tare.seconds` of 0: sum of each IMU's angle less that of its bend sensors at the start, and number.
    absolute: [[f64; 2]; MAX_SEGMENTS],
    tares: Vec<Tared>,
    findings: Vec<Finding>,
}

/// A tare that has ended.
#[derive(Debug, Clone)]
struct Tared {
    rows: Rows,
    /// Range of each heading, deg.
    moves: [f64; MAX_SEGMENTS],
    /// Largest bend angle against the reference pose, deg.
    bent: f64,
}

impl Tare {
    pub fn new(table: &ArmFile) -> Self {
        Self {
            seconds: table.tare.seconds,
            reference: reference_angles(table),
            ends_s: f64::NEG_INFINITY,
            rows: Rows::default(),
            segments: [EMPTY; MAX_SEGMENTS],
            absolute: [[0.0; 2]; MAX_SEGMENTS],
            tares: Vec::new(),
            findings: Vec::new(),
        }
    }

    pub fn update(&mut self, frame: &Frame) {
        if frame.starts {
            self.end();
            self.ends_s = frame.time_s + if self.is_absolute() { ABSOLUTE_S } else { self.seconds };
        }
        if frame.time_s >= self.ends_s {
            self.end();
            return;
        }
        self.rows.add(frame);
        if self.is_absolute() {
            self.add_absolute(frame);
            return;
        }
        for (i, segment) in self.segments.iter_mut().enumerate() {
            if !frame.theta[i].is_nan() {
                segment.sum += frame.theta[i];
                segment.count += 1.0;
            }
            let heading = frame.heading[i];
            if segment.first_heading.is_nan() {
                segment.first_heading = heading;
            }
            let turn = heading - segment.first_heading;
            segment.range = [segment.range[0].min(turn), segment.range[1].max(turn)];
        }
    }

    fn end(&mut self) {
        if self.rows.count == 0 {
            return;
        }
        let rows = std::mem::take(&mut self.rows);
        if self.is_absolute() {
            self.end_absolute(rows);
            return;
        }
        let segments = std::mem::replace(&mut self.segments, [EMPTY; MAX_SEGMENTS]);
        let moves = segments.map(|segment| segment.range[1] - segment.range[0]);
        let angles = segments.iter().zip(self.reference).map(|(segment, angle)| segment.sum / segment.count - angle);
        let bent = angles.filter(|angle| !angle.is_nan()).fold(0.0, |most: f64, angle| most.max(angle.abs()));
        self.tares.push(Tared { rows, moves, bent });
    }

    /// True where the table takes the first heading as it is.
    fn is_absolute(&self) -> bool {
        self.seconds == 0.0
    }

    fn add_absolute(&mut self, frame: &Frame) {
        for (i, sums) in self.absolute.iter_mut().enumerate() {
            let angle = wrapped(difference(&frame.heading, i) - frame.theta[i]);
            if !angle.is_nan() {
                *sums = [sums[0] + angle.abs(), sums[1] + 1.0];
            }
        }
    }

    fn end_absolute(&mut self, rows: Rows) {
        let angles = std::mem::take(&mut self.absolute).map(|[sum, number]| sum / number);
        let largest = angles.into_iter().fold(0.0, f64::max);
        if largest > NOT_ABSOLUTE {
            self.findings.push(Finding { sensor: Source::AllImus, rows, kind: Kind::NotAbsolute, figure: largest });
        }
    }

    pub fn finish(mut self, findings: &mut Vec<Finding>) {
        self.end();
        // Bend sensors that are wired wrongly show a bent arm.
        let is_any_blamed = (1..=MAX_SEGMENTS).any(|i| is_bend_blamed(findings, i));
        let sensor = Source::Arm;
        for Tared { rows, moves, bent } in self.tares {
            // The noise of an IMU that shows no heading is no motion.
            let seen = (1..).zip(moves).filter(|(i, _)| !is_imu_blamed(findings, *i));
            let moves = seen.fold(0.0, |most: f64, (_, range)| most.max(range));
            if moves > TARE_MOVES_DEG {
                self.findings.push(Finding { sensor, rows, kind: Kind::TareMoves, figure: moves });
            }
            if bent > BENT && !is_any_blamed {
                self.findings.push(Finding { sensor, rows, kind: Kind::TareBent, figure: bent });
            }
        }
        findings.append(&mut self.findings);
    }
}
