//! The IMUs: each must follow its own segment's end, with the right sign.
//!
//! Headings have an unknown zero and drift, so steps over one second are compared instead. An IMU measures them one to
//! one, and so the size counts as well: the ends of a module's two segments turn alike, but not equally far. The median over
//! the pieces of the sweep decides.

use super::error::{CalibrationError, Warning};
use super::pieces::{median, moving, pieces};
use super::sweep::{LEAST_ROWS, Sweep};

/// Share of the squared steps that a poor but correctly mounted IMU leaves unexplained.
const GOOD_ENOUGH: f64 = 0.1;
/// An IMU is swapped or inverted where that explains it this many times better than its own place does.
const BETTER: f64 = 4.0;
/// Unexplained share above which an IMU follows no segment.
const UNRELATED: f64 = 0.5;
/// Share of equal readings among the changed ones of two IMUs from which on both are one.
const SAME: f64 = 0.5;
/// Difference of equal headings after unwrapping, turns: rounding alone.
const EQUAL_TURNS: f64 = 1e-9;

pub(super) fn check(sweep: &Sweep) -> Result<Vec<Warning>, CalibrationError> {
    let lag = sweep.rate_hz.round().max(1.0) as usize;
    let mut warnings = Vec::new();
    for (i, imu) in sweep.imu.iter().enumerate() {
        if let Some(j) = (0..i).find(|j| are_same(imu, &sweep.imu[*j])) {
            return Err(CalibrationError::SameImus { segment: j + 1, other: i + 1 });
        }
    }
    let headings: Vec<Vec<Option<f64>>> =
        sweep.heading.iter().map(|heading| steps(heading, &sweep.runs, lag)).collect();
    for (i, imu) in sweep.imu.iter().enumerate() {
        let segment = i + 1;
        let imu = steps(imu, &sweep.runs, lag);
        let moving = moving(&headings[i]);
        let left = |j: usize, sign: f64| {
            median(moving.iter().map(|rows| unexplained(&imu[rows.clone()], &headings[j][rows.clone()], sign)))
        };
        let Some(own) = left(i, 1.0) else {
            warnings.push(Warning::ImuNotRead { segment });
            continue;
        };
        if own < GOOD_ENOUGH {
            continue;
        }
        let explains = |j: usize, sign| left(j, sign).filter(|left| left * BETTER < own);
        if explains(i, -1.0).is_some() {
            return Err(CalibrationError::InvertedImu { segment });
        }
        let others = (0..headings.len()).filter_map(|j| Some((j, explains(j, 1.0)?)));
        if let Some((j, _)) = others.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Err(CalibrationError::SwappedImu { segment, follows: j + 1 });
        }
        if own > UNRELATED {
            return Err(CalibrationError::UnrelatedImu { segment });
        }
    }
    Ok(warnings)
}

/// True where two IMUs give the same readings in most pieces. Readings that do not change may be equal by chance.
fn are_same(one: &[Option<f64>], other: &[Option<f64>]) -> bool {
    let share = |rows: std::ops::Range<usize>| {
        let (mut changed, mut equal) = (0_usize, 0_usize);
        for row in rows.skip(1) {
            let (now, before) = (one[row].zip(other[row]), one[row - 1].zip(other[row - 1]));
            let Some(((a, b), (a_before, b_before))) = now.zip(before) else { continue };
            if !are_equal(a, a_before) && !are_equal(b, b_before) {
                changed += 1;
                equal += usize::from(are_equal(a, b));
            }
        }
        (changed >= LEAST_ROWS / 2).then(|| equal as f64 / changed as f64)
    };
    median(pieces(one.len()).map(share)).is_some_and(|share| share > SAME)
}

/// True for the same direction.
fn are_equal(a_rad: f64, b_rad: f64) -> bool {
    let turns = (a_rad - b_rad) / std::f64::consts::TAU;
    (turns - turns.round()).abs() < EQUAL_TURNS
}

/// Change of each row over the next `lag` rows of the same run.
fn steps(column: &[Option<f64>], runs: &[u32], lag: usize) -> Vec<Option<f64>> {
    let ends = column.iter().zip(column.iter().skip(lag)).zip(runs.iter().zip(runs.iter().skip(lag)));
    ends.map(|((from, to), (run, end_run))| Some((*to)? - (*from)?).filter(|_| run == end_run)).collect()
}

/// Share of the squared steps of an IMU that `sign` times those of the truth leave; `None` where too few rows have both. The
/// mean step is taken out, as it is drift.
fn unexplained(imu: &[Option<f64>], truth: &[Option<f64>], sign: f64) -> Option<f64> {
    let pairs: Vec<(f64, f64)> = imu.iter().zip(truth).filter_map(|(a, b)| (*a).zip(*b)).collect();
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
