//! Findings of the wrong poses: rows and share of each kind.

use calibration_tables::MAX_SEGMENTS;

use super::fault::{Fault, FaultKind};
use super::row::TruthRow;
use crate::check::finding::{Finding, Kind, Rows, Source};

/// Least number of times that truth of a lower rate is held, least number of its repeats, and their least share in the rows in which the arm moves.
const HOLDS: u64 = 10;
const REPEATS: u64 = 20;
const SHARE: f64 = 0.2;
/// Longest period that is found, rows.
const LONGEST: usize = 64;
/// Turn of an IMU from row to row of an arm that moves, rad.
const TURN: f64 = 1.0 * std::f64::consts::PI / 180.0;

/// Kinds of a single segment's faults.
const KINDS: [(FaultKind, Kind); 4] = [
    (FaultKind::Zeros, Kind::TruthZeros),
    (FaultKind::Repeated, Kind::TruthRepeated),
    (FaultKind::Jump, Kind::TruthJump),
    (FaultKind::Misplaced, Kind::TruthMisplaced),
];

/// The tally.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    segments: usize,
    all: Rows,
    /// Number of poses of each segment.
    poses: [u64; MAX_SEGMENTS],
    wrong: [[Rows; KINDS.len()]; MAX_SEGMENTS],
    exchanged: Vec<([usize; 2], Rows)>,
    /// Repeats of all poses, by the first segment that has them.
    repeated: [Rows; MAX_SEGMENTS],
    periods: [u64; LONGEST],
    moving: u64,
    last: Option<TruthRow>,
}

impl Tally {
    pub fn new(segments: usize) -> Self {
        Self {
            segments,
            all: Rows::default(),
            poses: [0; MAX_SEGMENTS],
            wrong: [[Rows::default(); KINDS.len()]; MAX_SEGMENTS],
            exchanged: Vec::new(),
            repeated: [Rows::default(); MAX_SEGMENTS],
            periods: [0; LONGEST],
            moving: 0,
            last: None,
        }
    }

    /// All rows with truth.
    pub const fn rows(&self) -> Rows {
        self.all
    }

    pub fn add(&mut self, row: &TruthRow) {
        self.all.append(&row.rows());
        for (count, pose) in self.poses.iter_mut().zip(&row.poses).take(self.segments) {
            *count += u64::from(pose.is_some());
        }
        if let Some(last) = self.last.replace(*row) {
            let turns = last.imu.iter().zip(&row.imu).filter_map(|(from, to)| Some((*to)? - (*from)?));
            let most = turns.map(|turn| super::links::wrapped(turn).abs()).fold(0.0, f64::max);
            let is_changed = last.poses != row.poses;
            self.moving += u64::from(is_changed && most >= TURN);
        }
    }

    pub fn add_fault(&mut self, fault: &Fault) {
        let segment = fault.segment;
        match fault.kind {
            FaultKind::Exchanged(other) if segment < other => {
                let pair = [segment, other];
                match self.exchanged.iter_mut().find(|(of, _)| *of == pair) {
                    Some((_, rows)) => rows.append(&fault.rows),
                    None => self.exchanged.push((pair, fault.rows)),
                }
            }
            FaultKind::Exchanged(_) => {}
            FaultKind::AllRepeated => {
                self.repeated[segment].append(&fault.rows);
                let period = (fault.rows.last - fault.rows.first + 2) as usize;
                self.periods[period.min(LONGEST) - 1] += 1;
            }
            kind => {
                if let Some(place) = KINDS.iter().position(|(of, _)| *of == kind) {
                    self.wrong[segment][place].append(&fault.rows);
                }
            }
        }
    }

    /// Repeats of all poses.
    fn all_repeated(&self) -> Rows {
        self.repeated.iter().copied().max_by_key(|rows| rows.count).unwrap_or_default()
    }

    /// True for truth of a lower rate, which is held between its updates.
    pub fn is_staircase(&self) -> bool {
        let repeats = self.all_repeated().count;
        let holds = self.periods.iter().sum::<u64>() / self.segments as u64;
        holds >= HOLDS && repeats >= REPEATS && repeats as f64 > SHARE * (repeats + self.moving) as f64
    }

    /// Median number of rows from update to update.
    fn period(&self) -> usize {
        let half = self.periods.iter().sum::<u64>() / 2;
        let mut sum = 0;
        let is_half = |count: &u64| {
            sum += count;
            sum > half
        };
        self.periods.iter().position(is_half).map_or(1, |place| place + 1)
    }

    /// Share of the poses that are wrong, repeats of a lower rate aside.
    pub fn wrong_share(&self) -> f64 {
        let single = self.wrong.iter().flatten().map(|rows| rows.count).sum::<u64>();
        let exchanged = self.exchanged.iter().map(|(_, rows)| 2 * rows.count).sum::<u64>();
        let held = if self.is_staircase() { 0 } else { self.repeated.iter().map(|rows| rows.count).sum() };
        (single + exchanged + held) as f64 / self.poses.iter().sum::<u64>().max(1) as f64
    }

    /// Adds the findings.
    pub fn findings(&self, findings: &mut Vec<Finding>) {
        let percent = |count: u64, of: u64| 100.0 * count as f64 / of.max(1) as f64;
        let repeated = self.all_repeated();
        if repeated.count > 0 {
            let (kind, figure) = if self.is_staircase() {
                (Kind::TruthStaircase, self.period() as f64)
            } else {
                (Kind::TruthRepeated, percent(repeated.count, self.all.count))
            };
            findings.push(Finding { sensor: Source::AllTruth, rows: repeated, kind, figure });
        }
        for ([one, other], rows) in &self.exchanged {
            let sensor = Source::TwoTruths { segment: one + 1, other: other + 1 };
            let figure = percent(rows.count, self.all.count);
            findings.push(Finding { sensor, rows: *rows, kind: Kind::TruthExchanged, figure });
        }
        for (i, wrong) in self.wrong.iter().enumerate().take(self.segments) {
            for (rows, (_, kind)) in wrong.iter().zip(KINDS).filter(|(rows, _)| rows.count > 0) {
                let figure = percent(rows.count, self.poses[i]);
                findings.push(Finding { sensor: Source::Truth { segment: i + 1 }, rows: *rows, kind, figure });
            }
        }
    }
}
