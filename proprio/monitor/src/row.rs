//! What the page is told of one sample: columns with names, in the units that people read.

use estimator_core::{ImuReading, Q};
use proprio_session::{SENSOR_NAMES, Truth};
use telemetry::SegmentEstimate;

/// Columns that belong together, one or two a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Group {
    /// Bend angle θ_i by the filters.
    Theta,
    /// World position of the segment's end.
    X,
    Y,
    /// Raw counts of the bend sensors.
    Bend,
    /// Heading of the IMU as it was read.
    Imu,
    /// What the anchor takes from θ_imu,i: the IMUs' drift.
    Drift,
    /// z − H x⁻ of KF_orient by the drift-corrected IMUs.
    InnovationImu,
    /// The same by the bend sensors.
    InnovationBend,
    /// World position and heading of the segment's end, as the camera saw it.
    TruthX,
    TruthY,
    TruthHeading,
}

/// Each group, its columns' names around the number of the segment, and whether there is one for each bend sensor.
const GROUPS: [(Group, &str, &str, bool); 11] = [
    (Group::Theta, "theta", "_deg", false),
    (Group::X, "x", "_mm", false),
    (Group::Y, "y", "_mm", false),
    (Group::Bend, "bend", "_adc", true),
    (Group::Imu, "imu", "_deg", false),
    (Group::Drift, "drift", "_deg", false),
    (Group::InnovationImu, "innovation_imu", "_deg", false),
    (Group::InnovationBend, "innovation_bend", "_deg", false),
    (Group::TruthX, "truth", "_x_mm", false),
    (Group::TruthY, "truth", "_y_mm", false),
    (Group::TruthHeading, "truth", "_heading_deg", false),
];

/// Names of the columns for an arm of so many segments. The time has none of its own: it is in front of all.
pub(super) fn names(segments: usize) -> Vec<String> {
    let mut names = Vec::new();
    for (_, before, behind, is_sensors) in GROUPS {
        for i in 1..=segments {
            let sensors: &[char] = if is_sensors { &SENSOR_NAMES } else { &[] };
            names.extend(sensors.iter().map(|sensor| format!("{before}{i}{sensor}{behind}")));
            names.extend(sensors.is_empty().then(|| format!("{before}{i}{behind}")));
        }
    }
    names
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    /// Time since the begin of the session, or of the board's first run; it goes on over a restart.
    pub time_s: f64,
    /// One value a column; NaN where there is none.
    pub values: Vec<f32>,
    segments: usize,
}

impl Row {
    pub fn new(time_s: f64, segments: usize) -> Self {
        let columns: usize = GROUPS.iter().map(|(.., is_sensors)| segments * (1 + usize::from(*is_sensors))).sum();
        Self { time_s, values: vec![f32::NAN; columns], segments }
    }

    /// Sets the column of one segment, or bend sensor, from 0. To a ten-thousandth, which is more than anything here means.
    pub fn set(&mut self, group: Group, i: usize, value: Option<f64>) {
        let groups = GROUPS.iter().take_while(|(other, ..)| *other != group);
        let before: usize = groups.map(|(.., is_sensors)| self.segments * (1 + usize::from(*is_sensors))).sum();
        if let Some(place) = self.values.get_mut(before + i) {
            *place = value.map_or(f32::NAN, |value| ((value * 1e4).round() / 1e4) as f32);
        }
    }

    /// The raw readings.
    pub fn set_sample<const N: usize>(&mut self, sample: &estimator_core::Sample<N>) {
        for i in 0..self.segments.min(N) {
            for (j, counts) in sample.bend[i].iter().enumerate() {
                self.set(Group::Bend, 2 * i + j, counts.map(f64::from));
            }
            let heading = sample.imu[i].as_ref().and_then(ImuReading::heading);
            self.set(Group::Imu, i, heading.map(|heading| heading.rad().to_degrees()));
        }
    }

    /// What a board has estimated.
    pub fn set_estimate(&mut self, segments: &[Option<SegmentEstimate>]) {
        let value = |bits: i32| Q::from_bits(bits).to_f64();
        for (i, segment) in segments.iter().enumerate().take(self.segments) {
            self.set(Group::Theta, i, segment.map(|segment| value(segment.theta).to_degrees()));
            self.set(Group::X, i, segment.map(|segment| value(segment.end[0]) * 1e3));
            self.set(Group::Y, i, segment.map(|segment| value(segment.end[1]) * 1e3));
        }
    }

    /// Where the arm truly was.
    pub fn set_truth(&mut self, ends: &[Option<Truth>]) {
        for (i, end) in ends.iter().enumerate().take(self.segments) {
            self.set(Group::TruthX, i, end.map(|end| end.x_m * 1e3));
            self.set(Group::TruthY, i, end.map(|end| end.y_m * 1e3));
            let heading = end.and_then(|end| end.heading_rad);
            self.set(Group::TruthHeading, i, heading.map(f64::to_degrees));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Group, Row, names};

    #[test]
    fn every_value_is_in_the_column_of_its_name() {
        let names = names(3);
        let mut row = Row::new(0.0, 3);
        assert_eq!(names.len(), row.values.len());
        row.set(Group::Bend, 3, Some(1234.0));
        row.set(Group::TruthHeading, 2, Some(-0.123_456));
        let set: Vec<_> = names.iter().zip(&row.values).filter(|(_, value)| !value.is_nan()).collect();
        assert_eq!(set, [(&"bend2b_adc".to_owned(), &1234.0), (&"truth3_heading_deg".to_owned(), &-0.1235)]);
    }
}
