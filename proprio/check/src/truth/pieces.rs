//! Pieces of a session: scale of the truth, unit of its headings, and lag against the IMUs. The session's values are the medians
//! over its pieces, so that a fault of some of them does not decide about all.

use super::judge::LinkedRow;
use super::links::wrapped;
use crate::clock_fit::{ComparedSensors, Motion, Pair, Reading, Signal, fit};
use crate::median::median;

/// Length of a piece, s.
const PIECE_S: f64 = 120.0;
/// Least length of the last piece, s.
const LEAST_S: f64 = 50.0;
/// Largest direction of a segment by which the unit of headings is judged, rad: larger ones may be beyond half a turn.
const LARGEST_RAD: f64 = 2.0;
/// Least mean square direction, rad²: a straight arm has no unit.
const LEAST_SQUARE: f64 = 0.002;
/// Lags at which the fit is tried where it fails at 0, s: it finds the lag from up to a second off.
const STARTS_S: [f64; 8] = [1.5, -1.5, 3.0, -3.0, 4.5, -4.5, 6.0, -6.0];
/// Pieces at the start that are all compared with the IMUs, and the one in so many that is after them.
const FIRST_PIECES: usize = 4;
const EVERY: usize = 4;
/// Least range of a heading in a piece with motion, rad.
const MOTION: f64 = 0.1;
/// Largest error of a piece's lag, s.
const LAG_ERROR_S: f64 = 0.01;

/// Values of a session or one piece of it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Values {
    /// Lengths that the markers fit over those of the arm.
    pub scale: Option<f64>,
    /// Directions of the segments by the places over those by the headings.
    pub turn: Option<f64>,
    /// Time by which the truth is later than the IMUs, s.
    pub lag_s: Option<f64>,
}

/// Sums and readings of a piece.
#[derive(Debug, Clone)]
struct Piece {
    from_s: Option<f64>,
    last_s: f64,
    /// Products of true and expected lengths, and squares of the expected ones.
    lengths: [f64; 2],
    /// The same of the directions, and their number.
    directions: [f64; 2],
    squares: f64,
    count: f64,
    starts_s: Vec<f64>,
    imu: Vec<Vec<Reading>>,
    truth: Vec<Vec<Reading>>,
}

/// The pieces of a session: the memory holds one of them, and three numbers of each of the others.
#[derive(Debug, Clone)]
pub(super) struct Pieces {
    segments: usize,
    current: Piece,
    all: Vec<Values>,
    /// Lag at which the fit of the next piece begins, s; `None` before one was searched for.
    start_s: Option<f64>,
}

impl Pieces {
    pub fn new(segments: usize) -> Self {
        Self { segments, current: Piece::new(segments), all: Vec::new(), start_s: None }
    }

    /// Adds a row without its wrong poses.
    pub fn add(&mut self, row: &LinkedRow) {
        let time_s = row.row.time_s;
        let from_s = *self.current.from_s.get_or_insert(time_s);
        if time_s - from_s >= PIECE_S {
            self.end();
            self.current.from_s = Some(time_s);
        }
        self.current.add(row);
    }

    /// The medians over the pieces.
    pub fn finish(mut self) -> Values {
        let seconds = self.current.from_s.map_or(0.0, |from_s| self.current.last_s - from_s);
        if seconds >= LEAST_S || self.all.is_empty() {
            self.end();
        }
        let of = |value: fn(&Values) -> Option<f64>| median(self.all.iter().filter_map(value).collect());
        Values { scale: of(|piece| piece.scale), turn: of(|piece| piece.turn), lag_s: of(|piece| piece.lag_s) }
    }

    fn end(&mut self) {
        let piece = std::mem::replace(&mut self.current, Piece::new(self.segments));
        let mut values = piece.values();
        let is_compared = self.all.len() < FIRST_PIECES || self.all.len().is_multiple_of(EVERY);
        if let Some(motion) = piece.motion().filter(|_| is_compared) {
            values.lag_s = lag_s(&motion, self.start_s.unwrap_or(0.0));
            // Once: a search takes its time.
            if values.lag_s.is_none() && self.start_s.is_none() {
                values.lag_s = STARTS_S.into_iter().find_map(|start_s| lag_s(&motion, start_s));
                self.start_s = Some(values.lag_s.unwrap_or(0.0));
            }
        }
        self.all.push(values);
    }
}

impl Piece {
    fn new(segments: usize) -> Self {
        Self {
            from_s: None,
            last_s: 0.0,
            lengths: [0.0; 2],
            directions: [0.0; 2],
            squares: 0.0,
            count: 0.0,
            starts_s: Vec::new(),
            imu: vec![Vec::new(); segments],
            truth: vec![Vec::new(); segments],
        }
    }

    fn add(&mut self, LinkedRow { row, links }: &LinkedRow) {
        let time_s = row.time_s - self.from_s.unwrap_or(row.time_s);
        self.last_s = row.time_s;
        self.starts_s.extend(row.starts.then_some(time_s));
        for (i, (imu, truth)) in self.imu.iter_mut().zip(&mut self.truth).enumerate() {
            push_unwrapped(imu, time_s, row.imu[i]);
            push_unwrapped(truth, time_s, row.poses[i].and_then(|pose| pose.heading_rad));
            let Some(link) = links[i] else { continue };
            let expected = link.expected.norm();
            self.lengths[0] += link.end.norm() * expected;
            self.lengths[1] += expected * expected;
            // Directions from y, clockwise.
            let expected = link.start_rad + libm::atan2(link.expected.x, link.expected.y);
            let found = wrapped(link.start_rad + libm::atan2(link.end.x, link.end.y));
            if found.abs() < LARGEST_RAD {
                self.directions[0] += found * expected;
                self.directions[1] += expected * expected;
                self.squares += found * found;
                self.count += 1.0;
            }
        }
    }

    /// Scale and unit.
    fn values(&self) -> Values {
        let ratio = |[product, square]: [f64; 2]| (square > 0.0).then(|| product / square);
        let is_bent = self.squares > LEAST_SQUARE * self.count;
        Values { scale: ratio(self.lengths), turn: ratio(self.directions).filter(|_| is_bent), lag_s: None }
    }

    /// The motion by IMUs and truth; `None` without any.
    fn motion(&self) -> Option<Motion> {
        let range = |seen: &Vec<Reading>| {
            let ends =
                seen.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], (_, x)| [lo.min(*x), hi.max(*x)]);
            ends[1] - ends[0]
        };
        if self.truth.iter().map(range).fold(0.0, f64::max) < MOTION {
            return None;
        }
        let read = self.imu.iter().enumerate().filter(|(_, read)| !read.is_empty());
        let pairs: Vec<Pair> =
            read.map(|(camera, read)| Pair { sensor: Signal::new(read, &self.starts_s), camera }).collect();
        let cameras = self.truth.iter().map(|seen| Signal::new(seen, &[])).collect();
        (!pairs.is_empty()).then_some(Motion { pairs, cameras, by: ComparedSensors::Imus })
    }
}

/// Lag of the truth by the fine fit of `align`, which starts at `start_s`; `None` where the motion does not determine it.
fn lag_s(motion: &Motion, start_s: f64) -> Option<f64> {
    let fit = fit(motion, start_s).filter(|fit| {
        fit.correlation > motion.by.least_correlation()
            && fit.lag_error_s < LAG_ERROR_S
            && fit.residual_s < motion.by.most_residual_s()
    })?;
    Some(fit.clocks.camera_s(fit.middle_s) - fit.middle_s)
}

/// Adds a reading, at most half a turn from the one before.
fn push_unwrapped(readings: &mut Vec<Reading>, time_s: f64, heading_rad: Option<f64>) {
    let Some(heading_rad) = heading_rad else { return };
    let last = readings.last().map_or(heading_rad, |(_, last)| *last);
    // Equal times have no line between them.
    if readings.last().is_none_or(|(last_s, _)| time_s > *last_s) {
        readings.push((time_s, last + wrapped(heading_rad - last)));
    }
}
