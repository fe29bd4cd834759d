//! Conditions that degrade the estimate of a segment, one bit each.

use core::fmt;
use core::ops::BitOr;

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Conditions of one segment: those of [`estimator_core::Condition`], and
/// [`BENT_BEFORE_TARE`](Self::BENT_BEFORE_TARE). `Display` names them.
///
/// ```
/// use estimator_core::Condition;
/// use telemetry::Conditions;
///
/// let conditions = Conditions::from(Condition { imu_restarted: true, gated: true, ..Condition::default() });
/// assert!(conditions.is_degraded());
/// assert_eq!(conditions.to_string(), "the IMU has a new zero, bend sensors and IMUs disagree");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, Schema)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Conditions(pub u8);

/// Each bit, from the lowest, and its meaning.
const NAMES: [(u8, &str); 6] = [
    (Conditions::TARE_BAD.0, "the arm was bent or moving in the tare"),
    (1 << 1, "the IMU is absent"),
    (1 << 2, "the IMU has a new zero"),
    (1 << 3, "a bend sensor is not trusted"),
    (1 << 4, "bend sensors and IMUs disagree"),
    (Conditions::BENT_BEFORE_TARE.0, "the arm was bent before the tare, by its estimate"),
];

impl Conditions {
    /// The arm was bent or moving in the tare.
    pub const TARE_BAD: Self = Self(1);
    /// The tip was away from its place in the reference pose when a tare was requested, by more than three stated standard
    /// deviations: the arm was bent, or its estimate was wrong.
    pub const BENT_BEFORE_TARE: Self = Self(1 << 5);

    /// Returns whether any condition holds.
    #[must_use]
    pub const fn is_degraded(self) -> bool {
        self.0 != 0
    }

    /// Returns whether these conditions hold.
    #[must_use]
    pub const fn contains(self, others: Self) -> bool {
        self.0 & others.0 == others.0
    }
}

impl BitOr for Conditions {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl From<estimator_core::Condition> for Conditions {
    fn from(condition: estimator_core::Condition) -> Self {
        let estimator_core::Condition { tare_bad, imu_absent, imu_restarted, bend_distrusted, gated, .. } = condition;
        let held = NAMES.iter().zip([tare_bad, imu_absent, imu_restarted, bend_distrusted, gated]);
        Self(held.filter(|(_, holds)| *holds).fold(0, |bits, ((bit, _), _)| bits | bit))
    }
}

impl fmt::Display for Conditions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut held = NAMES.iter().filter(|(bit, _)| self.0 & bit != 0).map(|(_, name)| name);
        if let Some(first) = held.next() {
            f.write_str(first)?;
        }
        held.try_for_each(|name| write!(f, ", {name}"))
    }
}
