//! What degrades a board's estimate, for people.

use telemetry::{Health, PressureLimit};

/// Reasons why a board's estimate is degraded or its pressures are limited: a sentence for each segment, and one for the
/// pressures.
pub fn degradations(health: &Health) -> impl Iterator<Item = String> {
    let degraded = (1..).zip(&health.conditions).filter(|(_, conditions)| conditions.is_degraded());
    let segments = degraded.map(|(segment, conditions): (u32, _)| format!("segment {segment}: {conditions}"));
    let limit = match health.limit {
        PressureLimit::None => None,
        PressureLimit::SensorsLost => {
            Some("no pressure rises: all IMUs are lost, or all bend sensors of a segment".to_owned())
        }
        PressureLimit::SafeMode => Some("safe mode after repeated crashes: the pressures stay at zero".to_owned()),
    };
    segments.chain(limit)
}
