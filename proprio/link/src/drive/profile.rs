//! Profile of the pressures over time.

use std::path::Path;

use proprio_session::{PressurePoint, SessionError, read_pressures};

/// Pressures over time, linear between points.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// In the order of time; at least one.
    points: Vec<PressurePoint>,
    end_s: f64,
}

impl Profile {
    /// Reads a profile, which ends with its last point.
    ///
    /// # Errors
    /// [`SessionError`], with the line and the column.
    pub fn read(path: &Path) -> Result<Self, SessionError> {
        let points = read_pressures(path)?;
        let end_s = points.last().map_or(0.0, |last| last.time_s);
        Ok(Self { points, end_s })
    }

    /// The same pressures until `end_s`, which may be infinite.
    #[must_use]
    pub fn constant(pressures_pa: Vec<f64>, end_s: f64) -> Self {
        Self { points: vec![PressurePoint { time_s: 0.0, pressures_pa }], end_s }
    }

    /// Number of its regulators.
    #[must_use]
    pub fn regulators(&self) -> usize {
        self.points.first().map_or(0, |first| first.pressures_pa.len())
    }

    /// Time of its end, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// The pressures at a time, Pa: before the first point those of that point, from the end on 0. Of two points of the same
    /// time, which are a step, the second counts.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Vec<f64> {
        let vented = vec![0.0; self.regulators()];
        if time_s >= self.end_s {
            return vented;
        }
        let next = self.points.partition_point(|moment| moment.time_s <= time_s);
        match (next.checked_sub(1).and_then(|last| self.points.get(last)), self.points.get(next)) {
            (Some(from), Some(to)) => {
                let share = (time_s - from.time_s) / (to.time_s - from.time_s);
                let pairs = from.pressures_pa.iter().zip(&to.pressures_pa);
                pairs.map(|(from, to)| from + (to - from) * share).collect()
            }
            (Some(only), None) | (None, Some(only)) => only.pressures_pa.clone(),
            (None, None) => vented,
        }
    }

    /// The steepest change, Pa/s, and the number of the row, from 1, at its end.
    #[must_use]
    pub fn steepest(&self) -> Option<(f64, usize)> {
        let slope = |from: &PressurePoint, to: &PressurePoint| {
            let changes = from.pressures_pa.iter().zip(&to.pressures_pa).map(|(from, to)| (to - from).abs());
            let change = changes.fold(0.0, f64::max);
            if change > 0.0 { change / (to.time_s - from.time_s) } else { 0.0 }
        };
        let slopes = self.points.windows(2).zip(2..).map(|(pair, row)| (slope(&pair[0], &pair[1]), row));
        slopes.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

#[cfg(test)]
mod tests {
    use super::{PressurePoint, Profile};

    /// A ramp to 10 kPa within 2 s, a step to 30 kPa, and 1 s of that.
    fn profile() -> Profile {
        let points = [(1.0, 0.0), (3.0, 1e4), (3.0, 3e4), (4.0, 3e4)];
        let points = points.map(|(time_s, pa)| PressurePoint { time_s, pressures_pa: vec![pa, 0.0, pa] });
        Profile { points: points.to_vec(), end_s: 4.0 }
    }

    #[test]
    fn pressures_are_linear_between_points_and_end_vented() {
        let at = [0.0, 1.0, 2.0, 2.999, 3.0, 3.999, 4.0, 9.0].map(|time_s| profile().at(time_s)[2].round() as u32);
        assert_eq!(at, [0, 0, 5_000, 9_995, 30_000, 30_000, 0, 0]);
    }

    #[test]
    fn the_steepest_change_is_the_step() {
        assert_eq!(profile().steepest(), Some((f64::INFINITY, 3)));
        assert_eq!(Profile::constant(vec![1e4; 6], f64::INFINITY).steepest(), None);
    }

    #[test]
    fn constant_pressures_last_until_their_end() {
        let profile = Profile::constant(vec![1e4; 4], 2.0);
        assert_eq!([0.0, 1.9, 2.0].map(|time_s| profile.at(time_s)[3] as u32), [10_000, 10_000, 0]);
    }
}
