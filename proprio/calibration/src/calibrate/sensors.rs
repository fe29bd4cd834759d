//! The bend sensors: each fitted to its segment, and checked.

use std::ops::Range;

use calibration_tables::BendToml;

use super::error::{CalibrationError, Warning};
use super::fit::{QuadraticFit, quadratic, volts};
use super::maps::{self, FittedMap};
use super::options::CalibrationOptions;
use super::pieces::{median, moving};
use super::report::SensorReport;
use super::sweep::{LEAST_ROWS, SensorColumn, Sweep, range};

/// A sensor whose readings stay within this range is dead: ten times the noise of a good one.
pub(crate) const DEAD_COUNTS: u16 = 20;
/// Readings this close to the sensor's lowest or highest count as its end: the noise of a good one.
const END_COUNTS: u16 = 2;
/// Share of the rows at one end, and bending meanwhile, that make a sensor saturated.
const SATURATED: (f64, f64) = (0.01, 15.0 * std::f64::consts::PI / 180.0);
/// The same at the ends of the converter's range, where the reading is unambiguous.
const SATURATED_AT_RAIL: (f64, f64) = (0.01, 5.0 * std::f64::consts::PI / 180.0);
/// Error of an outlier, in RMSE of the map.
const OUTLIER: f64 = 6.0;
/// Unexplained share of the variance above which a sensor follows no segment.
pub(crate) const UNRELATED: f64 = 0.5;
/// A sensor is swapped where another segment explains it this many times better, and its own does it worse than
/// [`GOOD_ENOUGH`].
const SWAPPED: f64 = 4.0;
/// Share of the variance that a poor but correctly placed sensor leaves.
pub(crate) const GOOD_ENOUGH: f64 = 0.1;

/// One sensor's map.
pub(super) struct FittedSensor {
    pub segment: usize,
    pub map: BendToml,
    pub fitted: FittedMap,
    pub report: SensorReport,
    place: usize,
}

/// Fits all sensors of the sweep.
pub(super) fn fit(
    sweep: &Sweep,
    options: CalibrationOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<FittedSensor>, CalibrationError> {
    let columns = sweep.sensors.iter();
    let sensors = columns.map(|column| fit_one(sweep, column, options, warnings)).collect::<Result<Vec<_>, _>>()?;
    let names = sensors.iter().filter(|sensor| is_inverted(sensor, &sensors));
    warnings.extend(names.map(|sensor| Warning::Inverted { name: sensor.report.name.clone() }));
    Ok(sensors)
}

fn fit_one(
    sweep: &Sweep,
    column: &SensorColumn,
    options: CalibrationOptions,
    warnings: &mut Vec<Warning>,
) -> Result<FittedSensor, CalibrationError> {
    let name = column.name.clone();
    let pairs = pairs(&column.counts, &sweep.theta[column.segment]);
    if pairs.len() < LEAST_ROWS {
        return Err(CalibrationError::TooFewRows { name, found: pairs.len(), least: LEAST_ROWS });
    }
    check_alive(&name, &pairs)?;
    let mut fit =
        quadratic(&pairs).ok_or_else(|| CalibrationError::Dead { name: name.clone(), range: count_range(&pairs) })?;
    check_place(sweep, column, &fit)?;
    check_monotonic(&name, &mut fit, warnings)?;
    let is_off = |(counts, theta): &&(u16, f64)| (fit.map.angle(volts(*counts)) - theta).abs() > OUTLIER * fit.rmse;
    let count = pairs.iter().filter(is_off).count();
    warnings.extend((count > 0).then(|| Warning::Outliers { name: name.clone(), count }));
    let report = SensorReport {
        name,
        samples: fit.samples,
        rmse_deg: fit.rmse.to_degrees(),
        volts: fit.map.volts.unwrap_or_default(),
        range_deg: range(pairs.iter().map(|(_, theta)| *theta)).map(f64::to_degrees),
    };
    let fitted = maps::fit(sweep, column, &fit.map, options);
    let map = BendToml { curve: fitted.curve.clone(), memory: fitted.memory.clone(), ..fit.map };
    Ok(FittedSensor { segment: column.segment, map, fitted, report, place: column.place })
}

/// Readings and true angles of the rows that have both.
fn pairs(counts: &[Option<u16>], theta: &[Option<f64>]) -> Vec<(u16, f64)> {
    counts.iter().zip(theta).filter_map(|(counts, theta)| Some(((*counts)?, (*theta)?))).collect()
}

/// Share of a segment's bending that a quadratic of its own leaves in a piece of the sweep; `None` where too few rows have both.
fn unexplained(column: &SensorColumn, theta: &[Option<f64>], rows: Range<usize>) -> Option<f64> {
    let pairs = pairs(&column.counts[rows.clone()], &theta[rows]);
    if pairs.len() < LEAST_ROWS { None } else { Some(quadratic(&pairs)?.unexplained) }
}

fn ends(pairs: &[(u16, f64)]) -> [u16; 2] {
    pairs.iter().fold([u16::MAX, 0], |[lo, hi], (counts, _)| [lo.min(*counts), hi.max(*counts)])
}

fn count_range(pairs: &[(u16, f64)]) -> u16 {
    let [lo, hi] = ends(pairs);
    hi - lo
}

/// Refuses a dead sensor, or one that stays at one end of its range while the segment bends further.
fn check_alive(name: &str, pairs: &[(u16, f64)]) -> Result<(), CalibrationError> {
    let range_counts = count_range(pairs);
    if range_counts < DEAD_COUNTS {
        return Err(CalibrationError::Dead { name: name.to_owned(), range: range_counts });
    }
    for end in ends(pairs) {
        let at_end = pairs.iter().filter(|(counts, _)| counts.abs_diff(end) <= END_COUNTS);
        let mut thetas: Vec<f64> = at_end.map(|(_, theta)| *theta).collect();
        thetas.sort_unstable_by(f64::total_cmp);
        let share = thetas.len() as f64 / pairs.len() as f64;
        // Without a tenth at either side: a noisy sensor reaches its end occasionally.
        let tenth = thetas.len() / 10;
        let span = thetas[thetas.len() - 1 - tenth] - thetas[tenth];
        let (least_share, least_span) = if [0, 4095].contains(&end) { SATURATED_AT_RAIL } else { SATURATED };
        if share > least_share && span > least_span {
            let (percent, span_deg) = (share * 100.0, span.to_degrees());
            return Err(CalibrationError::Saturated { name: name.to_owned(), counts: end, percent, span_deg });
        }
    }
    Ok(())
}

/// Refuses a sensor that follows another segment than its own in most pieces of the sweep, or no segment.
fn check_place(sweep: &Sweep, column: &SensorColumn, fit: &QuadraticFit) -> Result<(), CalibrationError> {
    let name = column.name.clone();
    let moving = moving(&sweep.theta[column.segment]);
    let left = |j: usize| median(moving.iter().map(|rows| unexplained(column, &sweep.theta[j], rows.clone())));
    if let Some(own) = left(column.segment).filter(|own| *own > GOOD_ENOUGH) {
        let others = (0..sweep.theta.len()).filter(|j| *j != column.segment);
        let best = others.filter_map(|j| Some((j, left(j)?))).min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((j, _)) = best.filter(|(_, unexplained)| unexplained * SWAPPED < own) {
            return Err(CalibrationError::Swapped { name, follows: j + 1 });
        }
    }
    if fit.unexplained > UNRELATED {
        return Err(CalibrationError::Unrelated { name, percent: fit.unexplained * 100.0 });
    }
    Ok(())
}

/// Refuses a map that is not monotonic. It may turn back at the edge of its data by less than its residual; its range ends there.
fn check_monotonic(name: &str, fit: &mut QuadraticFit, warnings: &mut Vec<Warning>) -> Result<(), CalibrationError> {
    let Some([lo, hi]) = fit.map.volts.filter(|volts| !fit.map.is_monotonic_within(*volts)) else { return Ok(()) };
    let turning_point = fit.map.turning_point();
    let back = |end: f64| (fit.map.angle(end) - fit.map.angle(turning_point)).abs();
    let (name, back_deg) = (name.to_owned(), back(lo).min(back(hi)).to_degrees());
    if back_deg > fit.rmse.to_degrees() {
        return Err(CalibrationError::NotMonotonic { name, volts: turning_point, back_deg });
    }
    // One count short of it, where the map still has a slope.
    let margin = volts(1);
    fit.map.volts = Some(if back(lo) < back(hi) { [turning_point + margin, hi] } else { [lo, turning_point - margin] });
    warnings.push(Warning::TurnsBack { name, volts: turning_point, back_deg });
    Ok(())
}

fn rises(map: &BendToml) -> bool {
    let [lo, hi] = map.volts.unwrap_or_default();
    map.angle(hi) > map.angle(lo)
}

/// True where most sensors in the same place on the segments have the opposite sign.
fn is_inverted(sensor: &FittedSensor, all: &[FittedSensor]) -> bool {
    let like = || all.iter().filter(|other| other.place == sensor.place);
    let against = like().filter(|other| rises(&other.map) != rises(&sensor.map)).count();
    2 * against > like().count() && like().count() > 2
}
