//! The range that a segment has bent through, and how often.

/// Width of a bin, degrees.
const BIN_DEG: f64 = 5.0;
const BINS: usize = (360.0 / BIN_DEG) as usize;
/// Time in a bin from which on the bin counts as seen, s: what a slow sweep spends there in half a pass.
const SEEN_S: f64 = 0.5;
/// Part of the range at each end that a pass goes between.
const END_SHARE: f64 = 1.0 / 3.0;

/// Time that a bend angle has spent in each part of its range.
#[derive(Debug, Clone)]
pub(super) struct SeenRange {
    seconds: [f64; BINS],
    ends_deg: Option<[f64; 2]>,
}

impl Default for SeenRange {
    fn default() -> Self {
        Self { seconds: [0.0; BINS], ends_deg: None }
    }
}

impl SeenRange {
    /// Adds an angle within ±180° that has held for `seconds`.
    pub fn update(&mut self, seconds: f64, angle_deg: f64) {
        let bin = ((angle_deg + 180.0) / BIN_DEG).floor().clamp(0.0, (BINS - 1) as f64);
        self.seconds[bin as usize] += seconds;
        self.ends_deg = Some(widened(self.ends_deg, angle_deg));
    }

    /// The smallest and the largest angle.
    pub const fn ends_deg(&self) -> Option<[f64; 2]> {
        self.ends_deg
    }

    /// The parts of the range that were seen, in order.
    pub fn parts_deg(&self) -> Vec<[f64; 2]> {
        let Some([lowest, highest]) = self.ends_deg else { return Vec::new() };
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for bin in (0..BINS).filter(|bin| self.seconds[*bin] >= SEEN_S) {
            let from = bin as f64 * BIN_DEG - 180.0;
            let [low, high] = [from.max(lowest), (from + BIN_DEG).min(highest)];
            match parts.last_mut() {
                Some(last) if last[1] >= low => last[1] = high,
                _ => parts.push([low, high]),
            }
        }
        parts
    }
}

/// Time of a block of [`RecentRange`], s: about half a swing of a sweep.
const BLOCK_S: f64 = 15.0;

/// Range of a value in the last 15 to 30 s.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RecentRange {
    seconds: f64,
    now: Option<[f64; 2]>,
    before: Option<[f64; 2]>,
}

impl RecentRange {
    /// Adds a value that has held for `seconds`.
    pub fn update(&mut self, seconds: f64, value: f64) {
        self.seconds += seconds;
        if self.seconds >= BLOCK_S {
            (self.seconds, self.before, self.now) = (0.0, self.now, None);
        }
        self.now = Some(widened(self.now, value));
    }

    /// True where the values are further apart than this.
    pub fn is_wider(&self, width: f64) -> bool {
        self.width().is_some_and(|own| own > width)
    }

    /// True where all values are within this of each other.
    pub fn is_narrower(&self, width: f64) -> bool {
        self.width().is_some_and(|own| own < width)
    }

    /// The largest less the smallest value; `None` in the first block.
    fn width(&self) -> Option<f64> {
        let [low, high] = self.now?;
        let before = self.before?;
        Some(high.max(before[1]) - low.min(before[0]))
    }
}

/// Counter of the passes of a value from one end of its range to the other.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Passes {
    ends: Option<[f64; 2]>,
    /// The end where the value was last: the upper one.
    was_high: Option<bool>,
    pub count: u32,
}

impl Passes {
    /// Takes a value; a range smaller than `least` has no passes.
    pub fn update(&mut self, value: f64, least: f64) {
        let ends @ [low, high] = widened(self.ends, value);
        self.ends = Some(ends);
        let range = high - low;
        if range < least {
            return;
        }
        let share = (value - low) / range;
        let is_high = share > 1.0 - END_SHARE;
        if !is_high && share > END_SHARE {
            return;
        }
        self.count += u32::from(self.was_high.is_some_and(|was_high| was_high != is_high));
        self.was_high = Some(is_high);
    }
}

/// A range with another value in it.
pub(super) fn widened<T: PartialOrd + Copy>(ends: Option<[T; 2]>, value: T) -> [T; 2] {
    let Some([low, high]) = ends else { return [value; 2] };
    [if value < low { value } else { low }, if value > high { value } else { high }]
}

#[cfg(test)]
mod tests {
    use super::{Passes, SeenRange};

    #[test]
    fn a_part_that_was_jumped_over_is_a_gap_between_two_that_were_seen() {
        let mut seen = SeenRange::default();
        for tenth in -300..=200 {
            seen.update(0.1, f64::from(tenth) / 10.0);
        }
        for tenth in 310..=382 {
            seen.update(0.1, f64::from(tenth) / 10.0);
        }
        assert_eq!(seen.parts_deg(), [[-30.0, 20.0], [30.0, 38.2]].map(|part| [part[0], part[1]]).to_vec());
        assert_eq!(seen.ends_deg(), Some([-30.0, 38.2]));
    }

    #[test]
    fn noise_makes_no_pass_and_each_way_through_the_range_is_one() {
        let mut passes = Passes::default();
        for row in 0..1000 {
            passes.update(f64::from(row % 7) * 0.1, 10.0);
        }
        assert_eq!(passes.count, 0);
        // Two and a half swings: from the middle to an end, then four times across.
        for row in 0..2500 {
            passes.update(40.0 * libm::sin(f64::from(row) / 1000.0 * std::f64::consts::TAU), 10.0);
        }
        assert_eq!(passes.count, 4);
    }
}
