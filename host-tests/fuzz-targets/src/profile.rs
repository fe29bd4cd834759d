//! Profiles of pressures over time, which a board is driven by.

use board_table::MAX_FULL_SCALE_PA;
use proprio_link::drive::Profile;
use telemetry::MAX_REGULATORS;

use crate::input_file::{check_error, with_file};

/// Reads a text as a profile.
///
/// # Panics
/// Where a pressure of an accepted profile is out of the range of every regulator at any time; where pressures are left at
/// its end; where its steepest change is no number; and where an error has no line of the text.
pub fn profile(text: &[u8]) {
    let profile = match with_file(".csv", text, Profile::read) {
        Ok(profile) => profile,
        Err(error) => return check_error(&error, text),
    };
    let (regulators, end_s) = (profile.regulators(), profile.end_s());
    assert!((1..=MAX_REGULATORS).contains(&regulators) && end_s.is_finite() && end_s >= 0.0);
    for step in 0..=64 {
        let pressures = profile.at(end_s * f64::from(step) / 64.0);
        assert_eq!(pressures.len(), regulators);
        let most = f64::from(MAX_FULL_SCALE_PA) * (1.0 + f64::EPSILON);
        assert!(pressures.iter().all(|pressure| (0.0..=most).contains(pressure)), "{pressures:?}");
    }
    assert!(profile.at(end_s).iter().all(|pressure| *pressure == 0.0), "vented at its end");
    assert!(profile.steepest().is_none_or(|(slope, row)| slope >= 0.0 && row >= 2), "{:?}", profile.steepest());
}
