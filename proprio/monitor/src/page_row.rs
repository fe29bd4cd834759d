//! One sample as the page shows it: named columns in units for people.

use estimator_core::{ImuReading, Q};
use proprio_session::{SENSOR_NAMES, Truth};
use telemetry::SegmentEstimate;

/// Group of columns, one or two for each segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColumnGroup {
    /// Bend angle θ_i by the filters.
    Theta,
    /// World position of the segment's end.
    X,
    Y,
    /// Raw counts of the bend sensors.
    Bend,
    /// Heading of the IMU as it was read.
    Imu,
    /// Correction of θ_imu,i: the drift of the IMUs.
    Drift,
    /// Innovation z − H x⁻ of KF_orient by the drift-corrected IMUs.
    InnovationImu,
    /// Innovation of KF_orient by the bend sensors.
    InnovationBend,
    /// True world position and heading of the segment's end, by the camera.
    TruthX,
    TruthY,
    TruthHeading,
}

/// Each group with the prefix and suffix of its columns' names; true for a column per bend sensor.
const GROUPS: [(ColumnGroup, &str, &str, bool); 11] = [
    (ColumnGroup::Theta, "theta", "_deg", false),
    (ColumnGroup::X, "x", "_mm", false),
    (ColumnGroup::Y, "y", "_mm", false),
    (ColumnGroup::Bend, "bend", "_adc", true),
    (ColumnGroup::Imu, "imu", "_deg", false),
    (ColumnGroup::Drift, "drift", "_deg", false),
    (ColumnGroup::InnovationImu, "innovation_imu", "_deg", false),
    (ColumnGroup::InnovationBend, "innovation_bend", "_deg", false),
    (ColumnGroup::TruthX, "truth", "_x_mm", false),
    (ColumnGroup::TruthY, "truth", "_y_mm", false),
    (ColumnGroup::TruthHeading, "truth", "_heading_deg", false),
];

/// Names of the columns of an arm. The time is no column: it is in front of all.
pub(super) fn names(segments: usize) -> Vec<String> {
    let mut names = Vec::new();
    for (_, prefix, suffix, is_sensors) in GROUPS {
        for i in 1..=segments {
            let sensors: &[char] = if is_sensors { &SENSOR_NAMES } else { &[] };
            names.extend(sensors.iter().map(|sensor| format!("{prefix}{i}{sensor}{suffix}")));
            names.extend(sensors.is_empty().then(|| format!("{prefix}{i}{suffix}")));
        }
    }
    names
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PageRow {
    /// Time since the begin of the session, or of the board's first run, s; it continues over a restart.
    pub time_s: f64,
    /// One value per column; NaN for no value.
    pub values: Vec<f32>,
    segments: usize,
}

impl PageRow {
    pub fn new(time_s: f64, segments: usize) -> Self {
        let columns: usize = GROUPS.iter().map(|(.., is_sensors)| segments * (1 + usize::from(*is_sensors))).sum();
        Self { time_s, values: vec![f32::NAN; columns], segments }
    }

    /// Sets the column of one segment, or bend sensor, from 0, rounded to 10⁻⁴: less than the resolution of any column.
    pub fn set(&mut self, group: ColumnGroup, i: usize, value: Option<f64>) {
        let column = self.first_column(group) + i;
        if let Some(place) = self.values.get_mut(column) {
            *place = value.map_or(f32::NAN, |value| ((value * 1e4).round() / 1e4) as f32);
        }
    }

    fn first_column(&self, group: ColumnGroup) -> usize {
        let groups = GROUPS.iter().take_while(|(other, ..)| *other != group);
        groups.map(|(.., is_sensors)| self.segments * (1 + usize::from(*is_sensors))).sum()
    }

    /// The values of a group with one column for each segment.
    #[cfg(test)]
    pub fn group(&self, group: ColumnGroup) -> &[f32] {
        &self.values[self.first_column(group)..][..self.segments]
    }

    /// Sets the raw readings.
    pub fn set_sample<const N: usize>(&mut self, sample: &estimator_core::Sample<N>) {
        for i in 0..self.segments.min(N) {
            for (j, counts) in sample.bend[i].iter().enumerate() {
                self.set(ColumnGroup::Bend, 2 * i + j, counts.map(f64::from));
            }
            let heading = sample.imu[i].as_ref().and_then(ImuReading::heading);
            self.set(ColumnGroup::Imu, i, heading.map(|heading| heading.rad().to_degrees()));
        }
    }

    /// Sets the estimate of a board.
    pub fn set_estimate(&mut self, segments: &[Option<SegmentEstimate>]) {
        let value = |bits: i32| Q::from_bits(bits).to_f64();
        for (i, segment) in segments.iter().enumerate().take(self.segments) {
            self.set(ColumnGroup::Theta, i, segment.map(|segment| value(segment.theta).to_degrees()));
            self.set(ColumnGroup::X, i, segment.map(|segment| value(segment.end[0]) * 1e3));
            self.set(ColumnGroup::Y, i, segment.map(|segment| value(segment.end[1]) * 1e3));
        }
    }

    /// Sets the true poses of the segments' ends.
    pub fn set_truth(&mut self, ends: &[Option<Truth>]) {
        for (i, end) in ends.iter().enumerate().take(self.segments) {
            self.set(ColumnGroup::TruthX, i, end.map(|end| end.x_m * 1e3));
            self.set(ColumnGroup::TruthY, i, end.map(|end| end.y_m * 1e3));
            let heading = end.and_then(|end| end.heading_rad);
            self.set(ColumnGroup::TruthHeading, i, heading.map(f64::to_degrees));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ColumnGroup, PageRow, names};

    #[test]
    fn every_value_is_in_the_column_of_its_name() {
        let names = names(3);
        let mut row = PageRow::new(0.0, 3);
        assert_eq!(names.len(), row.values.len());
        row.set(ColumnGroup::Bend, 3, Some(1234.0));
        row.set(ColumnGroup::TruthHeading, 2, Some(-0.123_456));
        let set: Vec<_> = names.iter().zip(&row.values).filter(|(_, value)| !value.is_nan()).collect();
        assert_eq!(set, [(&"bend2b_adc".to_owned(), &1234.0), (&"truth3_heading_deg".to_owned(), &-0.1235)]);
    }
}
