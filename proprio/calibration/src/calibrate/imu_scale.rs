//! Sensitivity of each IMU's heading: its turns over those of the camera.
//!
//! Turns over a few seconds are large compared with the noise and with drift.

use super::statistics::quantile;
use super::sweep::{LEAST_ROWS, Sweep};

/// Time of a turn, s.
const TURN_S: f64 = 3.0;
/// Parts of the sweep, whose median is robust against a reset or a contact.
const PARTS: usize = 15;
/// Sensitivities that the table's format holds.
const RANGE: [f64; 2] = [0.9, 1.1];

/// Heading read over heading turned, of each IMU; `None` where it was hardly read.
pub(super) fn of(sweep: &Sweep) -> Vec<Option<f64>> {
    let lag = (TURN_S * sweep.rate_hz).round().max(1.0) as usize;
    let headings = sweep.imu.iter().zip(&sweep.heading);
    headings.map(|(imu, truth)| scale(imu, truth, &sweep.runs, lag)).collect()
}

fn scale(imu: &[Option<f64>], truth: &[Option<f64>], runs: &[u32], lag: usize) -> Option<f64> {
    let rows = runs.len().saturating_sub(lag);
    let turn = |column: &[Option<f64>], row: usize| Some(column[row + lag]? - column[row]?);
    let part = |part: usize| {
        let (mut product, mut square, mut count) = (0.0, 0.0, 0);
        for row in part * rows / PARTS..(part + 1) * rows / PARTS {
            if runs[row] != runs[row + lag] {
                continue;
            }
            let Some((read, turned)) = turn(imu, row).zip(turn(truth, row)) else { continue };
            let error = read - turned;
            let error = error - std::f64::consts::TAU * (error / std::f64::consts::TAU).round();
            product += error * turned;
            square += turned * turned;
            count += 1;
        }
        (count >= LEAST_ROWS && square > 0.0).then(|| product / square)
    };
    let mut errors: Vec<f64> = (0..PARTS).filter_map(part).collect();
    errors.sort_unstable_by(f64::total_cmp);
    (!errors.is_empty()).then(|| (1.0 + quantile(&errors, 0.5)).clamp(RANGE[0], RANGE[1]))
}

#[cfg(test)]
mod tests {
    use super::scale;

    /// A heading that swings by ±0.8 rad in 8 s, at 10 Hz.
    fn swing(rows: usize) -> Vec<Option<f64>> {
        (0..rows).map(|row| Some(0.8 * libm::sin(row as f64 * 0.1 * std::f64::consts::TAU / 8.0))).collect()
    }

    #[test]
    fn an_imu_that_reads_two_percent_too_much_is_found_in_spite_of_drift() {
        let truth = swing(3000);
        let read = |(row, heading): (usize, &Option<f64>)| heading.map(|heading| 1.02 * heading + 1e-4 * row as f64);
        let imu: Vec<_> = truth.iter().enumerate().map(read).collect();
        let found = scale(&imu, &truth, &vec![0; 3000], 30).expect("it was read");
        assert!((found - 1.02).abs() < 1e-3, "{found}");
    }

    #[test]
    fn an_imu_that_was_not_read_has_no_scale() {
        assert!(scale(&vec![None; 3000], &swing(3000), &vec![0; 3000], 30).is_none());
    }
}
