//! The columns that a session must have, by the use that is made of it.

use calibration_tables::{ArmFile, FileError};

/// The columns that a session must have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Needs {
    /// Bend sensors of each segment: 0, 1 (`a`) or 2 (`a` and `b`); `None`: as many as the session has.
    pub bend: Vec<Option<usize>>,
    /// Whether there must be truth.
    pub truth: bool,
}

impl Needs {
    /// What `table` needs of a session.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn of_table(table: &ArmFile) -> Result<Self, FileError> {
        let bend = table.bend_sensors()?.into_iter().map(Some).collect();
        Ok(Self { bend, truth: false })
    }

    /// What a calibration of `arm` needs of a session: the bend sensors are those that the session has.
    #[must_use]
    pub fn of_calibration(arm: &ArmFile) -> Self {
        let sensors = |bend: &Vec<_>| bend.is_empty().then_some(0);
        let bend = arm.segments.iter().map(|segment| segment.bend.as_ref().and_then(sensors)).collect();
        Self { bend, truth: true }
    }
}
