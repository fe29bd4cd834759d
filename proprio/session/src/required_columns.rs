//! The columns that a use of a session requires.

use calibration_tables::{ArmFile, FileError};

/// The columns that a session must have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RequiredColumns {
    /// Bend sensors of each segment: 0, 1 (`a`) or 2 (`a` and `b`); `None`: as many as the session has.
    pub bend: Vec<Option<usize>>,
    /// Require truth.
    pub truth: bool,
}

impl RequiredColumns {
    /// The columns that a replay with `table` requires.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn of_table(table: &ArmFile) -> Result<Self, FileError> {
        let bend = table.bend_sensors()?.into_iter().map(Some).collect();
        Ok(Self { bend, truth: false })
    }

    /// The columns that a calibration of `arm` requires; its bend sensors are those of the session.
    #[must_use]
    pub fn of_calibration(arm: &ArmFile) -> Self {
        let sensors = |bend: &Vec<_>| bend.is_empty().then_some(0);
        let bend = arm.segments.iter().map(|segment| segment.bend.as_ref().and_then(sensors)).collect();
        Self { bend, truth: true }
    }
}
