//! `bend_error`: size and persistence of the errors that the maps leave of the sweep.

use calibration_tables::BendErrorKeys;

use super::maps::FittedMap;
use super::sweep::{LEAST_ROWS, Sweep};

/// Rate of the series, that of the bias filter, Hz.
const RATE_HZ: f64 = 10.0;
/// Smallest deviation: what a sweep of a quarter of an hour can show.
const LEAST_DEG: f64 = 0.3;
/// Held-back error over that of the fit.
const HELD_BACK_RATIO: [f64; 2] = [1.0, 1.5];
/// Time of a mean of the slow errors, s.
const SLOW_S: f64 = 60.0;
/// Longest lag of the autocorrelation, s, and the value at which it has decayed.
const LONGEST_LAG_S: f64 = 30.0;
const DECAYED: f64 = 0.05;

/// Values at an even rate, in runs of the estimator.
struct Series {
    values: Vec<Option<f64>>,
    runs: Vec<u32>,
    step_s: f64,
}

/// Errors of the sensors of `segment`; `None` where they were hardly ever read together.
pub(super) fn of(sweep: &Sweep, segment: usize, sensors: &[&FittedMap]) -> Option<BendErrorKeys> {
    let errors: Vec<Series> = sensors.iter().map(|sensor| Series::new(&sensor.errors, sweep)).collect();
    let first = errors.first()?;
    let second = errors.get(1).unwrap_or(first);
    let mean = first.combine(second, |a, b| (a + b) / 2.0);
    let difference = first.combine(second, |a, b| (a - b) / 2.0);
    if mean.values.iter().flatten().count() < LEAST_ROWS {
        return None;
    }
    let ratio = sensors.iter().map(|sensor| held_back_ratio(sensor)).sum::<f64>() / sensors.len() as f64;
    let deviation_deg = |series: &Series| (series.deviation() * ratio).to_degrees().max(LEAST_DEG);
    let slow_difference = difference.slow_deviation().unwrap_or(difference.deviation() / 2.0);
    let slow_mean = mean.slow_deviation().unwrap_or(0.0);
    let correlation_s = mean.correlation_s();
    Some(BendErrorKeys {
        mean_deg: rounded(deviation_deg(&mean)),
        sensor_deg: errors.iter().map(|series| rounded(deviation_deg(series))).collect(),
        difference_deg: rounded(difference.deviation().to_degrees()),
        slow_difference_deg: rounded(slow_difference.to_degrees()),
        slow_ratio: if slow_difference > 0.0 { rounded((slow_mean / slow_difference).powi(2).min(1.0)) } else { 0.0 },
        travel_deg: rounded(correlation_s * Series::new(&sweep.theta[segment], sweep).speed().to_degrees()),
        correlation_s: rounded(correlation_s),
    })
}

/// Four digits behind the point.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

fn held_back_ratio(sensor: &FittedMap) -> f64 {
    let [fitted, held_back] = [&sensor.errors, &sensor.held_back].map(|errors| super::rms(errors.iter().flatten().copied()));
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
        deviation(&self.values)
    }

    /// Standard deviation of the means of every stretch of [`SLOW_S`]; `None` where there is none.
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
            means.extend((is_whole && 2 * count > length).then(|| Some(sum / count as f64)));
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

/// Standard deviation of the values that are there.
fn deviation(values: &[Option<f64>]) -> f64 {
    let count = values.iter().flatten().count().max(1) as f64;
    let mean = values.iter().flatten().sum::<f64>() / count;
    super::rms(values.iter().flatten().map(|value| value - mean))
}
