//! Weaknesses of firmware and estimator that the soak has found: they are counted, and do not fail it.

use super::finding::Invariant;

/// A fault, the invariant that it breaks, and why that stands.
pub struct Known {
    /// Kind of the fault, as in the tables.
    pub fault: &'static str,
    /// The invariant.
    pub invariant: Invariant,
    /// The reason.
    pub reason: &'static str,
}

/// All of them.
pub const KNOWN: &[Known] = &[Known {
    fault: OFFSET_TARE,
    invariant: Invariant::Tip,
    reason: "the zero is that of the pose at the tare; an arm that rests bent after a swing is flagged in it only where the \
             estimate before the tare was bent, too",
}];

/// A tare, or a boot with its tare, of an arm that was not straight.
pub const OFFSET_TARE: &str = "tare of an arm that is not straight";

/// The weakness that explains why these faults break an invariant.
pub fn known<'f>(mut faults: impl Iterator<Item = &'f str>, invariant: Invariant) -> Option<&'static Known> {
    faults.find_map(|fault| KNOWN.iter().find(|known| known.fault == fault && known.invariant == invariant))
}
