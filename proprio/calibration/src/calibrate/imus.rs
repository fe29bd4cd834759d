//! The IMUs: each must follow its own segment's end, with the right sign.
//!
//! Headings have an unknown zero and drift, so steps over one second are compared instead. An IMU measures them one to
//! one, and so the size counts as well: the ends of a module's two segments turn alike, but not equally far.

use super::error::{CalibrationError, Warning};
use super::sweep::{LEAST_ROWS, Sweep};

/// Share of the squared steps that a poor but correctly mounted IMU leaves unexplained.
const GOOD_ENOUGH: f64 = 0.1;
/// An IMU is swapped or inverted where that explains it this many times better than its own place does.
const BETTER: f64 = 4.0;
/// Unexplained share above which an IMU follows no segment.
const UNRELATED: f64 = 0.5;

pub(super) fn check(sweep: &Sweep) -> Result<Vec<Warning>, CalibrationError> {
    let lag = sweep.rate_hz.round().max(1.0) as usize;
    let mut warnings = Vec::new();
    for (i, imu) in sweep.imu.iter().enumerate() {
        let segment = i + 1;
        let Some(own) = unexplained(imu, &sweep.heading[i], &sweep.runs, lag, 1.0) else {
            warnings.push(Warning::ImuNotRead { segment });
            continue;
        };
        if own < GOOD_ENOUGH {
            continue;
        }
        let explains = |j: usize, sign| {
            unexplained(imu, &sweep.heading[j], &sweep.runs, lag, sign).filter(|left| left * BETTER < own)
        };
        if explains(i, -1.0).is_some() {
            return Err(CalibrationError::InvertedImu { segment });
        }
        let others = (0..sweep.heading.len()).filter_map(|j| Some((j, explains(j, 1.0)?)));
        if let Some((j, _)) = others.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Err(CalibrationError::SwappedImu { segment, follows: j + 1 });
        }
        if own > UNRELATED {
            return Err(CalibrationError::UnrelatedImu { segment });
        }
    }
    Ok(warnings)
}

/// Share of the squared steps of `imu` over `lag` rows of one run that `sign` times those of `truth` leave; `None` where
/// too few rows have both. The mean step is taken out, as it is drift.
fn unexplained(imu: &[Option<f64>], truth: &[Option<f64>], runs: &[u32], lag: usize, sign: f64) -> Option<f64> {
    let is_in_one_run: Vec<bool> = runs.iter().zip(runs.iter().skip(lag)).map(|(from, to)| from == to).collect();
    let steps = |column: &[Option<f64>]| -> Vec<Option<f64>> {
        let ends = column.iter().zip(column.iter().skip(lag)).zip(&is_in_one_run);
        ends.map(|((from, to), is_in_one_run)| Some((*to)? - (*from)?).filter(|_| *is_in_one_run)).collect()
    };
    let pairs: Vec<(f64, f64)> = steps(imu).into_iter().zip(steps(truth)).filter_map(|(a, b)| a.zip(b)).collect();
    if pairs.len() < LEAST_ROWS {
        return None;
    }
    let variance = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
    };
    let left = variance(pairs.iter().map(|(a, b)| a - sign * b).collect());
    let all = variance(pairs.iter().map(|(a, _)| *a).collect());
    Some(if all > 0.0 { left / all } else { 1.0 })
}
