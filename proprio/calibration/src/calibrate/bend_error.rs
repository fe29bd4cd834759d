//! `bend_error`: size and persistence of the maps' errors in the sweep.

use calibration_tables::BendErrorToml;

use super::maps::FittedMap;
use super::statistics::rms;
use super::sweep::{LEAST_ROWS, Sweep};

/// Rate of the series, that of the bias filter, Hz.
const RATE_HZ: f64 = 10.0;
/// Smallest deviation: what a sweep of a quarter of an hour can show.
const LEAST_DEG: f64 = 0.3;
/// Smallest offset of a session that a few sweeps can show, and the largest of the table's format.
const LEAST_OFFSET_DEG: f64 = 0.5;
const MAX_OFFSET_DEG: f64 = 20.0;
/// Held-back error over that of the fit.
const HELD_BACK_RATIO: [f64; 2] = [1.0, 1.5];
/// Time of a mean of the slow errors, s.
const SLOW_S: f64 = 60.0;
/// Longest lag of the autocorrelation, s, and the value at which it has decayed.
const LONGEST_LAG_S: f64 = 30.0;
const DECAYED: f64 = 0.05;
/// Largest travel of the table's format.
const MAX_TRAVEL_DEG: f64 = 1000.0;

/// Values at an even rate, in runs of the estimator.
struct Series {
    values: Vec<Option<f64>>,
    runs: Vec<u32>,
    step_s: f64,
}

/// Errors of the sensors of `segment`; `None` where they were hardly ever read together.
pub(super) fn of(sweep: &Sweep, segment: usize, sensors: &[&FittedMap]) -> Option<BendErrorToml> {
    let errors = sensors.iter().map(|sensor| Series::new(&centred(&sensor.errors, sweep), sweep));
    let errors: Vec<Series> = errors.collect();
    let first = errors.first()?;
    let second = errors.get(1).unwrap_or(first);
    let mean = first.combine(second, f64::midpoint);
    let difference = first.combine(second, |a, b| (a - b) / 2.0);
    if mean.values.iter().flatten().count() < LEAST_ROWS {
        return None;
    }
    let ratio = sensors.iter().map(|sensor| held_back_ratio(sensor)).sum::<f64>() / sensors.len() as f64;
    let deviation_deg = |series: &Series| (series.deviation() * ratio).to_degrees().max(LEAST_DEG);
    let slow_difference = difference.slow_deviation().unwrap_or(difference.deviation() / 2.0);
    let slow_mean = mean.slow_deviation().unwrap_or(0.0);
    let correlation_s = mean.correlation_s();
    let speed = Series::new(&sweep.theta[segment], sweep).speed();
    Some(BendErrorToml {
        mean_deg: rounded(deviation_deg(&mean)),
        sensor_deg: errors.iter().map(|series| rounded(deviation_deg(series))).collect(),
        noise_deg: rounded(errors.iter().map(Series::noise).fold(0.0, f64::max).to_degrees()),
        difference_deg: rounded(difference.deviation().to_degrees()),
        slow_difference_deg: rounded(slow_difference.to_degrees()),
        slow_ratio: if slow_difference > 0.0 { rounded((slow_mean / slow_difference).powi(2).min(1.0)) } else { 0.0 },
        travel_deg: rounded((correlation_s * speed.to_degrees()).min(MAX_TRAVEL_DEG)),
        correlation_s: rounded(correlation_s),
    })
}

/// Errors less their session's mean, which is an offset of its own.
fn centred(errors: &[Option<f64>], sweep: &Sweep) -> Vec<Option<f64>> {
    let means = session_means(errors, sweep);
    let rows = errors.iter().zip(&sweep.sessions);
    rows.map(|(error, session)| Some((*error)? - means[*session]?)).collect()
}

/// Mean of each session.
fn session_means(errors: &[Option<f64>], sweep: &Sweep) -> Vec<Option<f64>> {
    let sessions = sweep.sessions.last().map_or(0, |last| last + 1);
    let mut sums = vec![(0.0, 0.0_f64); sessions];
    for (error, session) in errors.iter().zip(&sweep.sessions) {
        if let Some(error) = error {
            sums[*session].0 += error;
            sums[*session].1 += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| (count > 0.0).then(|| sum / count)).collect()
}

/// Standard deviation of the sessions' mean errors of a segment, rad; `None` of a single session.
pub(super) fn session_deviation(sweep: &Sweep, sensors: &[&FittedMap]) -> Option<f64> {
    let first = sensors.first()?;
    let last = sensors.last()?;
    let both = first.errors.iter().zip(&last.errors);
    let mean: Vec<_> = both.map(|(a, b)| Some(f64::midpoint((*a)?, (*b)?))).collect();
    let means: Vec<f64> = session_means(&mean, sweep).into_iter().flatten().collect();
    let count = means.len() as f64;
    // Bessel's correction: the mean is that of the same sessions.
    (means.len() > 1).then(|| deviation(&means) * (count / (count - 1.0)).sqrt())
}

/// `drift.offset_deg` of all segments' deviations, rad.
pub(super) fn offset_deg(deviations: &[f64]) -> f64 {
    rounded(rms(deviations.iter().copied()).to_degrees().clamp(LEAST_OFFSET_DEG, MAX_OFFSET_DEG))
}

/// Rounds to four decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

fn held_back_ratio(sensor: &FittedMap) -> f64 {
    let [fitted, held_back] = [&sensor.errors, &sensor.held_back].map(|errors| rms(errors.iter().flatten().copied()));
    if fitted > 0.0 { (held_back / fitted).clamp(HELD_BACK_RATIO[0], HELD_BACK_RATIO[1]) } else { HELD_BACK_RATIO[0] }
}

impl Series {
    /// Means of as many rows as make the rate.
    fn new(column: &[Option<f64>], sweep: &Sweep) -> Self {
        let rows = (sweep.rate_hz / RATE_HZ).round().max(1.0) as usize;
        let mean = |values: &[Option<f64>]| {
            let count = values.iter().flatten().count();
            (count > 0).then(|| values.iter().flatten().sum::<f64>() / count as f64)
        };
        let blocks = column.chunk_by_run(&sweep.runs);
        let (mut values, mut runs) = (Vec::new(), Vec::new());
        for (run, block) in blocks {
            for chunk in block.chunks(rows) {
                values.push(mean(chunk));
                runs.push(run);
            }
        }
        Self { values, runs, step_s: rows as f64 / sweep.rate_hz }
    }

    fn combine(&self, other: &Self, both: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| Some(both((*a)?, (*b)?))).collect();
        Self { values, runs: self.runs.clone(), step_s: self.step_s }
    }

    fn deviation(&self) -> f64 {
        deviation(&self.values.iter().flatten().copied().collect::<Vec<f64>>())
    }

    /// Standard deviation of the change from one value to the next.
    fn noise(&self) -> f64 {
        let pairs = self.values.windows(2).zip(self.runs.windows(2)).filter(|(_, runs)| runs[0] == runs[1]);
        let changes: Vec<f64> = pairs.filter_map(|(pair, _)| Some(pair[1]? - pair[0]?)).collect();
        deviation(&changes)
    }

    /// Standard deviation of the means of every stretch of [`SLOW_S`]; `None` without two of them.
    fn slow_deviation(&self) -> Option<f64> {
        let length = (SLOW_S / self.step_s).round().max(1.0) as usize;
        let (mut sum, mut count) = (0.0, 0_usize);
        let mut means = Vec::new();
        for (last, value) in self.values.iter().enumerate() {
            sum += value.unwrap_or(0.0);
            count += usize::from(value.is_some());
            if let Some(gone) = last.checked_sub(length) {
                sum -= self.values[gone].unwrap_or(0.0);
                count -= usize::from(self.values[gone].is_some());
            }
            let is_whole = last + 1 >= length && self.runs[last + 1 - length] == self.runs[last];
            means.extend((is_whole && 2 * count > length).then(|| sum / count as f64));
        }
        (means.len() > 1).then(|| deviation(&means))
    }

    /// Twice the integral of the autocorrelation up to where it has decayed, s.
    fn correlation_s(&self) -> f64 {
        let count = self.values.iter().flatten().count().max(1) as f64;
        let mean = self.values.iter().flatten().sum::<f64>() / count;
        let product = |lag: usize| {
            let (mut sum, mut count) = (0.0, 0.0_f64);
            for row in 0..self.values.len().saturating_sub(lag) {
                if self.runs[row] != self.runs[row + lag] {
                    continue;
                }
                if let Some((a, b)) = self.values[row].zip(self.values[row + lag]) {
                    sum += (a - mean) * (b - mean);
                    count += 1.0;
                }
            }
            sum / count.max(1.0)
        };
        let variance = product(0);
        if variance <= 0.0 {
            return self.step_s;
        }
        let lags = 0..(LONGEST_LAG_S / self.step_s).round() as usize;
        let correlations = lags.map(|lag| product(lag) / variance).take_while(|correlation| *correlation >= DECAYED);
        2.0 * self.step_s * correlations.sum::<f64>()
    }

    /// Mean size of the rate of change, a second.
    fn speed(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for (values, runs) in self.values.windows(3).zip(self.runs.windows(3)) {
            if let (&[Some(from), _, Some(to)], true) = (values, runs[0] == runs[2]) {
                sum += (to - from).abs() / (2.0 * self.step_s);
                count += 1.0;
            }
        }
        sum / count.max(1.0)
    }
}

/// A column in its runs.
trait ChunkByRun {
    fn chunk_by_run<'c>(&'c self, runs: &'c [u32]) -> impl Iterator<Item = (u32, &'c [Option<f64>])>;
}

impl ChunkByRun for [Option<f64>] {
    fn chunk_by_run<'c>(&'c self, runs: &'c [u32]) -> impl Iterator<Item = (u32, &'c [Option<f64>])> {
        let mut rest = self;
        runs.chunk_by(|a, b| a == b).map(move |run| {
            let (block, behind) = rest.split_at(run.len());
            rest = behind;
            (run[0], block)
        })
    }
}

/// Standard deviation.
fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    rms(values.iter().map(|value| value - mean))
}

#[cfg(test)]
mod tests {
    use super::super::sweep::Sweep;
    use super::{FittedMap, of, offset_deg, session_deviation};
    use crate::calibrate::options::MapKind;

    const ROWS: usize = 9000;

    /// 15 min at 10 Hz, a swing of 20 s.
    fn sweep() -> Sweep {
        let theta =
            (0..ROWS).map(|row| Some(0.8 * libm::sin(row as f64 * 0.1 * std::f64::consts::TAU / 20.0))).collect();
        Sweep::of_sensor(10.0, vec![Some(2000); ROWS], theta, vec![0; ROWS])
    }

    fn sensor(error_deg: impl Fn(usize) -> f64) -> FittedMap {
        let errors: Vec<_> = (0..ROWS).map(|row| Some(error_deg(row).to_radians())).collect();
        FittedMap { kind: MapKind::Curve, curve: None, memory: None, held_back: errors.clone(), errors }
    }

    /// Errors of 1° and independent of each other: signs by two patterns that have nothing in common.
    fn sign(row: usize, shift: u32) -> f64 {
        if (row as u32).wrapping_mul(2_654_435_769) >> shift & 1 == 0 { 1.0 } else { -1.0 }
    }

    #[test]
    fn two_sensors_with_independent_errors_have_a_mean_that_is_better_by_the_root_of_two() {
        let error =
            of(&sweep(), 0, &[&sensor(|row| sign(row, 20)), &sensor(|row| sign(row, 25))]).expect("both are read");
        assert!((error.sensor_deg[0] - 1.0).abs() < 0.01 && (error.sensor_deg[1] - 1.0).abs() < 0.01);
        assert!((error.mean_deg - 0.707).abs() < 0.03 && (error.difference_deg - 0.707).abs() < 0.03, "{error:?}");
        assert!(error.slow_difference_deg < 0.1, "{error:?}");
    }

    #[test]
    fn an_error_that_changes_every_ten_seconds_has_a_correlation_of_ten_seconds() {
        let one = sensor(|row| sign(row / 100, 20));
        let error = of(&sweep(), 0, &[&one, &one]).expect("both are read");
        // A triangle of 10 s: twice its integral.
        assert!((7.0..13.0).contains(&error.correlation_s), "{error:?}");
        // 4 · 0.8 rad in 20 s.
        let speed_deg_per_s = 4.0 * 0.8_f64.to_degrees() / 20.0;
        assert!((error.travel_deg / error.correlation_s - speed_deg_per_s).abs() < 0.2, "{error:?}");
        assert!(error.difference_deg == 0.0 && error.slow_ratio == 0.0);
    }

    #[test]
    fn a_segment_with_one_sensor_has_no_difference() {
        let error = of(&sweep(), 0, &[&sensor(|row| sign(row, 20))]).expect("it is read");
        assert_eq!((error.sensor_deg.len(), error.difference_deg, error.slow_difference_deg), (1, 0.0, 0.0));
        assert!(of(&sweep(), 0, &[]).is_none());
    }

    #[test]
    fn a_change_between_two_sessions_is_an_offset_and_no_error_within_them() {
        let mut sweep = sweep();
        sweep.sessions = (0..ROWS).map(|row| row / (ROWS / 2)).collect();
        let one = sensor(|row| if row < ROWS / 2 { 2.0 } else { -2.0 } + 0.5 * sign(row, 20));
        let error = of(&sweep, 0, &[&one]).expect("it is read");
        assert!((error.mean_deg - 0.5).abs() < 0.02, "{error:?}");
        let deviation = session_deviation(&sweep, &[&one]).expect("two sessions");
        assert!((offset_deg(&[deviation]) - 8.0_f64.sqrt()).abs() < 0.05);
    }
}
