//! The IMUs: each must follow its own segment's end, with the right sign.
//!
//! Headings have an unknown zero and drift, so steps over one second are compared instead. An IMU measures them one to
//! one, and so the size counts as well: the ends of a module's two segments turn alike, but not equally far. The median over
//! the pieces of a session decides about it.

use std::f64::consts::TAU;
use std::ops::Range;

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

/// Checks the IMUs of each session; an error has the session's number, from 0.
pub(super) fn check(sweep: &Sweep) -> Result<Vec<Warning>, (usize, CalibrationError)> {
    let mut is_read = vec![false; sweep.imu.len()];
    let mut first = 0;
    for rows in sweep.sessions.chunk_by(|a, b| a == b) {
        let end = first + rows.len();
        check_session(sweep, first..end, &mut is_read).map_err(|error| (rows[0], error))?;
        first = end;
    }
    let not_read = (1..).zip(is_read).filter(|(_, is_read)| !is_read);
    Ok(not_read.map(|(segment, _)| Warning::ImuNotRead { segment }).collect())
}

/// Checks the IMUs in the rows of one session, and notes those that were read.
fn check_session(sweep: &Sweep, rows: Range<usize>, is_read: &mut [bool]) -> Result<(), CalibrationError> {
    let lag = sweep.rate_hz.round().max(1.0) as usize;
    let runs = &sweep.runs[rows.clone()];
    let imus: Vec<&[Option<f64>]> = sweep.imu.iter().map(|imu| &imu[rows.clone()]).collect();
    for (i, imu) in imus.iter().enumerate() {
        if let Some(j) = (0..i).find(|j| are_same(imu, imus[*j])) {
            return Err(CalibrationError::SameImus { segment: j + 1, other: i + 1 });
        }
    }
    let headings: Vec<Vec<Option<f64>>> =
        sweep.heading.iter().map(|heading| steps(&heading[rows.clone()], runs, lag)).collect();
    for (i, imu) in imus.iter().enumerate() {
        let segment = i + 1;
        let imu = steps(imu, runs, lag);
        let moving = moving(&headings[i]);
        let left = |imu: &[Option<f64>], j: usize, sign: f64| {
            median(moving.iter().map(|rows| unexplained(&imu[rows.clone()], &headings[j][rows.clone()], sign)))
        };
        let Some(own) = left(&imu, i, 1.0) else { continue };
        is_read[i] = true;
        if own < GOOD_ENOUGH {
            continue;
        }
        if left(&of_radians(&imu), i, 1.0).is_some_and(|left| left < GOOD_ENOUGH) {
            return Err(CalibrationError::RadianImu { segment });
        }
        let explains = |j: usize, sign| left(&imu, j, sign).filter(|left| left * BETTER < own && *left < UNRELATED);
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
    Ok(())
}

/// Steps of headings that were radians in a column of degrees.
fn of_radians(steps: &[Option<f64>]) -> Vec<Option<f64>> {
    let wrapped = |rad: f64| rad - TAU * (rad / TAU).round();
    steps.iter().map(|step| step.map(|step| wrapped(step.to_degrees()))).collect()
}

/// True where two IMUs give the same readings in most pieces. Readings that do not change may be equal by chance.
fn are_same(one: &[Option<f64>], other: &[Option<f64>]) -> bool {
    let share = |rows: Range<usize>| {
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
    let turns = (a_rad - b_rad) / TAU;
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
