//! A column as a function of time, and its low-frequency differences, by which the recordings are compared.

/// Span of the two means of a difference, s. It keeps motion within seconds and removes drift, noise and the short errors of an
/// IMU's own filter.
const SPAN_S: f64 = 2.0;
/// Period of the compared differences, s.
pub const GRID_S: f64 = 0.1;
/// Longest time between readings that is no pause, s.
const PAUSE_S: f64 = 0.3;
/// The same at low rates, in usual sampling periods.
const PAUSE_STEPS: f64 = 2.5;

/// A time, s, and the value read then.
pub type Reading = (f64, f64);

/// A column, linear between readings.
pub struct Signal {
    points: Vec<Point>,
}

#[derive(Clone, Copy)]
struct Point {
    time_s: f64,
    value: f64,
    /// Integral of the lines since the first reading.
    area: f64,
    /// Time in pauses since then.
    hidden_s: f64,
    /// The line to it is no motion: it crosses a pause or a new zero.
    is_hidden: bool,
}

impl Signal {
    /// The signal of readings in the order of time, which have a new zero from each of `starts_s` on.
    #[must_use]
    pub fn new(readings: &[Reading], starts_s: &[f64]) -> Self {
        let mut steps: Vec<f64> = readings.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        steps.sort_unstable_by(f64::total_cmp);
        let usual_s = steps.get(steps.len() / 2).copied().unwrap_or_default();
        let pause_s = PAUSE_S.max(PAUSE_STEPS * usual_s);
        let runs_before = |time_s: f64| starts_s.partition_point(|start_s| *start_s <= time_s);
        let mut points: Vec<Point> = Vec::with_capacity(readings.len());
        for (time_s, value) in readings {
            points.push(match points.last() {
                None => Point { time_s: *time_s, value: *value, area: 0.0, hidden_s: 0.0, is_hidden: false },
                Some(last) => {
                    let starts = runs_before(last.time_s) < runs_before(*time_s);
                    last.line_to(*time_s, *value, starts || time_s - last.time_s > pause_s)
                }
            });
        }
        Self { points }
    }

    /// Times of the first and the last reading, s.
    #[must_use]
    pub fn ends_s(&self) -> Option<[f64; 2]> {
        Some([self.points.first()?.time_s, self.points.last()?.time_s])
    }

    /// The differences, from the first on.
    #[must_use]
    pub const fn steps(&self) -> Steps<'_> {
        Steps { points: self.points.as_slice(), after: [0; 3] }
    }
}

/// Differences of a signal, one after another: each search begins where the last one has ended.
pub struct Steps<'s> {
    points: &'s [Point],
    /// Number of readings up to the begin, the middle and the end of the last difference.
    after: [usize; 3],
}

impl Steps<'_> {
    fn at(&mut self, place: usize, time_s: f64) -> Option<Point> {
        let after = &mut self.after[place];
        while self.points.get(*after).is_some_and(|point| point.time_s <= time_s) {
            *after += 1;
        }
        while self.points[..*after].last().is_some_and(|point| point.time_s > time_s) {
            *after -= 1;
        }
        let (from, to) = (self.points.get(after.checked_sub(1)?)?, self.points.get(*after)?);
        let value = from.value + (to.value - from.value) * (time_s - from.time_s) / (to.time_s - from.time_s);
        Some(from.line_to(time_s, value, to.is_hidden))
    }

    /// The difference at `time_s`, which is the mean over the span after it less the mean over the span before, and its rate
    /// of change; `None` where the column has a pause in these spans.
    #[must_use]
    pub fn at_time(&mut self, time_s: f64) -> Option<[f64; 2]> {
        let before = self.at(0, time_s - SPAN_S);
        let now = self.at(1, time_s);
        let after = self.at(2, time_s + SPAN_S);
        let (before, now, after) = (before?, now?, after?);
        let seen = after.hidden_s <= before.hidden_s;
        let second_difference = |of: fn(&Point) -> f64| (of(&after) - 2.0 * of(&now) + of(&before)) / SPAN_S;
        seen.then(|| [second_difference(|point| point.area), second_difference(|point| point.value)])
    }
}

impl Point {
    /// The end of a line from it.
    fn line_to(&self, time_s: f64, value: f64, is_hidden: bool) -> Self {
        let since_s = time_s - self.time_s;
        let hidden_s = if is_hidden { since_s } else { 0.0 };
        let area = self.area + since_s * f64::midpoint(self.value, value);
        Self { time_s, value, area, hidden_s: self.hidden_s + hidden_s, is_hidden }
    }
}

#[cfg(test)]
mod tests {
    use super::Signal;

    #[test]
    fn a_ramp_has_a_difference_of_its_slope_times_the_span_at_any_sampling() {
        let times = [0.0, 1.0, 1.1, 1.11, 3.0, 3.5, 6.0];
        let signal = Signal::new(&times.map(|time| (time, 3.0 * time)), &[]);
        let [step, rate] = signal.steps().at_time(2.5).expect("it lies within");
        assert!((step - 6.0).abs() < 1e-12 && rate.abs() < 1e-12, "{step}, {rate}");
    }

    #[test]
    fn there_is_no_step_across_a_pause_or_beyond_the_ends() {
        let times = (0..400).map(|k| f64::from(k) / 20.0).filter(|t| !(8.0..8.4).contains(t));
        let signal = Signal::new(&times.map(|time| (time, time)).collect::<Vec<_>>(), &[]);
        let mut steps = signal.steps();
        let known = [1.9, 2.1, 5.9, 6.2, 8.2, 10.3, 10.5, 17.9, 18.0].map(|time| steps.at_time(time).is_some());
        assert_eq!(known, [false, true, true, false, false, false, true, true, false]);
    }
}
