//! The IMUs: each must follow its own segment's end, the right way round.
//!
//! Headings have an unknown zero and drift, so steps over one second are compared instead.

use super::error::{CalibrationError, Warning};
use super::sweep::{LEAST_ROWS, Sweep};

/// Correlation below which an IMU does not follow.
const FOLLOWS: f64 = 0.7;
/// An IMU is swapped where another segment's end leaves this share of what its own leaves.
const SWAPPED: f64 = 0.25;

pub(super) fn check(sweep: &Sweep) -> Result<Vec<Warning>, CalibrationError> {
    let lag = sweep.rate_hz.round().max(1.0) as usize;
    let mut warnings = Vec::new();
    for (i, imu) in sweep.imu.iter().enumerate() {
        let segment = i + 1;
        let Some(own) = correlation(imu, &sweep.heading[i], lag) else {
            warnings.push(Warning::ImuNotRead { segment });
            continue;
        };
        if own < -FOLLOWS {
            return Err(CalibrationError::InvertedImu { segment });
        }
        let others = (0..sweep.heading.len()).filter(|j| *j != i);
        let others = others.filter_map(|j| Some((j, correlation(imu, &sweep.heading[j], lag)?)));
        let best = others.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((j, _)) = best.filter(|(_, other)| 1.0 - other < SWAPPED * (1.0 - own)) {
            return Err(CalibrationError::SwappedImu { segment, follows: j + 1 });
        }
        if own < FOLLOWS {
            return Err(CalibrationError::UnrelatedImu { segment });
        }
    }
    Ok(warnings)
}

/// Correlation of the steps over `lag` rows; `None` where too few rows have both.
fn correlation(imu: &[Option<f64>], truth: &[Option<f64>], lag: usize) -> Option<f64> {
    let steps = |column: &[Option<f64>]| -> Vec<Option<f64>> {
        column.iter().zip(column.iter().skip(lag)).map(|(from, to)| Some((*to)? - (*from)?)).collect()
    };
    let pairs: Vec<(f64, f64)> = steps(imu).into_iter().zip(steps(truth)).filter_map(|(a, b)| a.zip(b)).collect();
    if pairs.len() < LEAST_ROWS {
        return None;
    }
    let n = pairs.len() as f64;
    let (mean_a, mean_b) = pairs.iter().fold((0.0, 0.0), |(a, b), pair| (a + pair.0 / n, b + pair.1 / n));
    let product = |f: fn(f64, f64) -> f64| pairs.iter().map(|(a, b)| f(a - mean_a, b - mean_b)).sum::<f64>();
    let (aa, ab, bb) = (product(|a, _| a * a), product(|a, b| a * b), product(|_, b| b * b));
    Some(if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 })
}
