//! Monitor of the arm's rest: the range of each heading in the last half second, for a tare.

use estimator_core::{ImuReading, Phase};
use telemetry::MAX_SEGMENTS;

/// Largest range of a heading of an arm at rest, in units of 2⁻²⁶ rad: 1°, ten times an IMU's noise.
pub const REST_RANGE: i32 = 1_171_270;

/// Ticks of half the window: the range is that of the last 25 to 50 ticks, 0.25 to 0.5 s.
const HALF_WINDOW_TICKS: u8 = 25;

/// 2⁻³² turns in units of 2⁻⁵² rad.
const PHASE_RAD: i64 = 6_588_397;

/// Monitor of the headings' ranges.
///
/// ```
/// use board_core::RestMonitor;
///
/// let mut monitor = RestMonitor::new();
/// for _ in 0..50 {
///     monitor.step(&[Some([16384, 0, 0, 0])]);
/// }
/// assert_eq!(monitor.most_turned(), Some((0, 0)));
/// ```
#[derive(Debug)]
pub struct RestMonitor {
    ticks: u8,
    earlier: [Range; MAX_SEGMENTS],
    newest: [Range; MAX_SEGMENTS],
}

/// Range of one heading, in 2⁻³² turns from its first value.
#[derive(Debug, Clone, Copy)]
enum Range {
    /// No tick yet.
    Empty,
    /// The IMU was read in every tick.
    Whole { first: Phase, low: i32, high: i32 },
    /// The IMU was not read in some tick.
    Unknown,
}

impl Range {
    fn extend(&mut self, heading: Option<Phase>) {
        *self = match (*self, heading) {
            (Self::Unknown, _) | (_, None) => Self::Unknown,
            (Self::Empty, Some(first)) => Self::Whole { first, low: 0, high: 0 },
            (Self::Whole { first, low, high }, Some(heading)) => {
                let turned = (heading - first).bits();
                Self::Whole { first, low: low.min(turned), high: high.max(turned) }
            }
        };
    }

    /// Range of both, in units of 2⁻²⁶ rad.
    fn with(&self, newest: &Self) -> Option<i32> {
        let &Self::Whole { first, low, high } = self else { return None };
        let (low, high) = match *newest {
            Self::Unknown => return None,
            Self::Empty => (low, high),
            Self::Whole { first: next, low: next_low, high: next_high } => {
                let shift = i64::from((next - first).bits());
                let of = |bits: i32| (i64::from(bits) + shift).clamp(i32::MIN.into(), i32::MAX.into()) as i32;
                (low.min(of(next_low)), high.max(of(next_high)))
            }
        };
        let turned = (i64::from(high) - i64::from(low)) * PHASE_RAD;
        Some((turned >> 26) as i32)
    }
}

impl RestMonitor {
    /// A monitor before its first tick.
    pub const fn new() -> Self {
        Self { ticks: 0, earlier: [Range::Unknown; MAX_SEGMENTS], newest: [Range::Empty; MAX_SEGMENTS] }
    }

    /// Takes the valid raw quaternions of a tick.
    pub fn step(&mut self, imu: &[Option<[i16; 4]>]) {
        if self.ticks >= HALF_WINDOW_TICKS {
            self.earlier = core::mem::replace(&mut self.newest, [Range::Empty; MAX_SEGMENTS]);
            self.ticks = 0;
        }
        self.ticks += 1;
        for (range, imu) in self.newest.iter_mut().zip(imu) {
            range.extend(imu.and_then(|imu| ImuReading::from_bno055(imu).heading()));
        }
    }

    /// Segment, counted from 0, whose heading turned most, and the range of that heading in units of 2⁻²⁶ rad; `None`: no IMU
    /// was read throughout.
    pub fn most_turned(&self) -> Option<(u8, i32)> {
        let ranges = (0..).zip(self.earlier.iter().zip(&self.newest));
        let ranges = ranges.filter_map(|(segment, (earlier, newest))| Some((segment, earlier.with(newest)?)));
        ranges.max_by_key(|(_, range)| *range)
    }
}

impl Default for RestMonitor {
    fn default() -> Self {
        Self::new()
    }
}
