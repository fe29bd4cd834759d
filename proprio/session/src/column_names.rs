//! Names of columns.

use estimator_core::SENSORS_PER_SEGMENT;

/// Names of the sensors of a segment.
pub const SENSOR_NAMES: [char; SENSORS_PER_SEGMENT] = ['a', 'b'];

/// Columns of a pose, in both units.
const POSE_PARTS: [&str; 6] = ["x_mm", "x_m", "y_mm", "y_m", "heading_deg", "heading_rad"];

/// The column of the times.
pub(crate) const TIME: &str = "time_s";

/// The column of the tare's number.
pub const TARE: &str = "tare";

/// The segment of a column; 0 for columns of the whole arm, `None` for an unknown column.
pub(crate) fn segment_of(name: &str) -> Option<usize> {
    if name == TIME || name == TARE {
        return Some(0);
    }
    let (stem, rest) = name.split_once('_')?;
    let (digits, known): (&str, &[&str]) = if let Some(digits) = stem.strip_prefix("bend") {
        (digits.strip_suffix(SENSOR_NAMES)?, &["adc"])
    } else if let Some(digits) = stem.strip_prefix("imu") {
        (digits, &["deg", "rad", "qw", "qx", "qy", "qz"])
    } else {
        (stem.strip_prefix("truth")?, &POSE_PARTS)
    };
    digits.parse().ok().filter(|_| known.contains(&rest))
}

/// True for a column of a session, a camera's file or a profile.
pub(crate) fn is_known(name: &str) -> bool {
    segment_of(name).is_some() || is_base(name) || is_pressure(name)
}

/// True for a column of the truth.
pub(crate) fn is_truth(name: &str) -> bool {
    name.starts_with("truth") && segment_of(name).is_some()
}

/// True for a column of the base's marker.
pub(crate) fn is_base(name: &str) -> bool {
    name.strip_prefix("base_").is_some_and(|part| POSE_PARTS.contains(&part))
}

/// True for a column of a regulator's pressure.
pub(crate) fn is_pressure(name: &str) -> bool {
    regulator_of(name).is_some()
}

/// The regulator of a column of pressures, from 1.
pub(crate) fn regulator_of(name: &str) -> Option<usize> {
    let (digits, unit) = name.strip_prefix("pressure")?.split_once('_')?;
    digits.parse().ok().filter(|_| ["kpa", "pa"].contains(&unit))
}
