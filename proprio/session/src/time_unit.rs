//! The unit of the times, by the rate of the rows.

/// Factors of an arm's rate over the session's outside which the times are not in seconds. Sessions of 1000 Hz are known, and of
/// 1 Hz, with tables for 10 Hz.
const SLOWER: f64 = 20.0;
const FASTER: f64 = 1.0 / 110.0;
/// Minutes instead of seconds, and the tolerance of this factor.
const MINUTES: f64 = 1.0 / 60.0;
const TOLERANCE: f64 = 0.02;

/// Units that times may have in place of seconds: how many of each are a second, and the name.
const UNITS: [(f64, &str); 4] =
    [(1e3, "milliseconds"), (1e6, "microseconds"), (MINUTES, "minutes"), (MINUTES / 60.0, "hours")];

/// The factor by which the times of a session are too large, where they are not in seconds: an arm's usual rate over the
/// session's rate, both Hz.
#[must_use]
pub fn time_factor(usual_hz: f64, rate_hz: f64) -> Option<f64> {
    let factor = usual_hz / rate_hz;
    let is_wrong = !(FASTER..=SLOWER).contains(&factor) || (factor / MINUTES - 1.0).abs() < TOLERANCE;
    is_wrong.then_some(factor)
}

/// The exact factor and the name of the unit with this [factor](time_factor), if it is one.
#[must_use]
pub fn time_unit_of(factor: f64) -> Option<(f64, &'static str)> {
    UNITS.into_iter().find(|(unit, _)| (factor / unit - 1.0).abs() < TOLERANCE)
}
