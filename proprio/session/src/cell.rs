//! One cell: text to a checked reading.

use board_table::MAX_FULL_SCALE_PA;
use estimator_core::{ImuReading, Phase};

use crate::SessionProblem;
use crate::shown::shown;

/// Units of 2⁻³⁰ in 1.
const QUATERNION_ONE: f64 = 1_073_741_824.0;
/// Largest true coordinate or heading, m or rad.
const MAX_TRUTH: f64 = 1e5;
/// Latest time that a session may have, s.
const MAX_TIME_S: f64 = 100.0 * 365.25 * 86_400.0;

/// The number in a cell; `None` for an empty one.
pub(crate) fn number(cell: &str) -> Result<Option<f64>, SessionProblem> {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        Ok(_) => Err(SessionProblem::NotFinite(shown(cell))),
        Err(_) => match cell.trim() {
            "" => Ok(None),
            trimmed if trimmed.len() < cell.len() => number(trimmed),
            _ => Err(SessionProblem::NotANumber(shown(cell))),
        },
    }
}

/// Raw ADC counts.
pub(crate) fn counts(cell: &str) -> Result<Option<u16>, SessionProblem> {
    match cell.parse::<u16>() {
        Ok(counts) if counts <= 4095 => Ok(Some(counts)),
        _ => number(cell)?.map(|value| whole_counts(value, cell)).transpose(),
    }
}

/// Some programs write whole numbers as `512.0`.
fn whole_counts(value: f64, cell: &str) -> Result<u16, SessionProblem> {
    if value.fract() == 0.0 && (0.0..=4095.0).contains(&value) {
        Ok(value as u16)
    } else {
        Err(SessionProblem::Counts(shown(cell)))
    }
}

/// A time, µs.
pub(crate) fn time_us(cell: &str) -> Result<u64, SessionProblem> {
    let seconds = number(cell)?.ok_or(SessionProblem::NoTime)?;
    if (0.0..=MAX_TIME_S).contains(&seconds) {
        Ok((seconds * 1e6).round() as u64)
    } else {
        Err(SessionProblem::Time(shown(cell)))
    }
}

/// The tare's number.
pub(crate) fn tare(cell: &str) -> Result<Option<u64>, SessionProblem> {
    let cell = cell.trim();
    let number = |_| SessionProblem::Tare(shown(cell));
    if cell.is_empty() { Ok(None) } else { cell.parse().map(Some).map_err(number) }
}

/// A time by a clock that may start anywhere, s.
pub(crate) fn clock_s(cell: &str) -> Result<f64, SessionProblem> {
    let seconds = number(cell)?.ok_or(SessionProblem::NoTime)?;
    if seconds.abs() <= MAX_TIME_S { Ok(seconds) } else { Err(SessionProblem::Clock(shown(cell))) }
}

/// A heading in units of `factor` rad. A whole turn is accepted: 359.99999 may be rounded to it.
pub(crate) fn heading(cell: &str, factor: f64) -> Result<Option<ImuReading>, SessionProblem> {
    let Some(value) = number(cell)? else { return Ok(None) };
    let rad = value * factor;
    if !(0.0..=std::f64::consts::TAU + 1e-6).contains(&rad) {
        return Err(SessionProblem::Heading(shown(cell)));
    }
    Ok(Some(ImuReading::Heading(Phase::from_rad(rad))))
}

/// A true coordinate or heading in units of `factor` m or rad.
pub(crate) fn truth(cell: &str, factor: f64) -> Result<Option<f64>, SessionProblem> {
    let value = number(cell)?.map(|value| value * factor);
    if value.is_some_and(|value| value.abs() > MAX_TRUTH) { Err(SessionProblem::Truth(shown(cell))) } else { Ok(value) }
}

/// A pressure in units of `factor` Pa, that the largest regulator of a board can give.
pub(crate) fn pressure_pa(cell: &str, factor: f64) -> Result<f64, SessionProblem> {
    let pressure_pa = number(cell)?.ok_or(SessionProblem::NoPressure)? * factor;
    if (0.0..=f64::from(MAX_FULL_SCALE_PA)).contains(&pressure_pa) {
        Ok(pressure_pa)
    } else {
        Err(SessionProblem::Pressure(shown(cell)))
    }
}

/// A unit quaternion w, x, y, z, kept to 2⁻³⁰: a BNO055's 2⁻¹⁴ exactly.
pub(crate) fn quaternion(parts: [Option<f64>; 4]) -> Result<Option<ImuReading>, SessionProblem> {
    match parts {
        [None, None, None, None] => Ok(None),
        [Some(w), Some(x), Some(y), Some(z)] => {
            let reading = ImuReading::Quaternion([w, x, y, z].map(|part| (part * QUATERNION_ONE).round() as i32));
            let norm = (w * w + x * x + y * y + z * z).sqrt();
            // Near 1, only a sensor on its side has no heading; that is a missing reading, not a broken file.
            if (norm - 1.0).abs() > 0.01 { Err(SessionProblem::NotUnit(norm)) } else { Ok(Some(reading)) }
        }
        _ => Err(SessionProblem::PartialQuaternion),
    }
}
