//! Days and times of day of the host's clock, UTC.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::HostNs;

const DAY_S: u64 = 24 * 3600;
/// The begin of 2000, s: recordings that a conversion has made have times near 1970.
const LEAST_S: u64 = 946_684_800;

/// Today, as `2026-11-30`; the day of the variable `SOURCE_DATE_EPOCH` where it is set, so that a build can be repeated.
#[must_use]
pub fn today() -> String {
    let set = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|seconds| seconds.parse().ok());
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    day(set.unwrap_or_else(now))
}

/// A time as `2026-11-30 14:05 UTC`; `None` where it was not read from a clock.
///
/// ```
/// use proprio_session::{HostNs, utc_minute};
///
/// assert_eq!(utc_minute(HostNs(1_709_164_859_000_000_000)).as_deref(), Some("2024-02-29 00:00 UTC"));
/// assert_eq!(utc_minute(HostNs(5)), None);
/// ```
#[must_use]
pub fn utc_minute(time: HostNs) -> Option<String> {
    let seconds = time.0 / 1_000_000_000;
    let (hour, minute) = (seconds % DAY_S / 3600, seconds % 3600 / 60);
    (seconds >= LEAST_S).then(|| format!("{} {hour:02}:{minute:02} UTC", day(seconds)))
}

/// Day of a time since 1970 in the Gregorian calendar (Hinnant, "chrono-compatible low-level date algorithms").
fn day(seconds: u64) -> String {
    // Days since 0000-03-01, so that leap days end a year.
    let days = seconds / DAY_S + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (month, year) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", year_of_era + era * 400 + year)
}
