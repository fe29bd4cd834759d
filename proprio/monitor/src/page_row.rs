//! One sample as the page shows it: named columns in units for people.

use estimator_core::{ImuReading, Q, VARIANCE_SCALE};
use proprio_session::{SENSOR_NAMES, Truth};
use serde::Serialize;
use telemetry::{SegmentEstimate, Uncertainty};

/// Numbers of the parts of an arm that have columns.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub(super) struct ArmSize {
    pub segments: usize,
    pub regulators: usize,
}

/// Group of columns, one for each part of one kind.
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
    /// Standard deviation of θ_i.
    ThetaDeviation,
    /// Covariance of the segment's end in {W}.
    EndXx,
    EndXy,
    EndYy,
    /// Largest change of the residual within half a second, in percent of the free arm's limit.
    ContactScore,
    /// 1 in contact, else 0.
    InContact,
    /// True world position and heading of the segment's end, by the camera.
    TruthX,
    TruthY,
    TruthHeading,
    /// Pressure of a regulator that the host has requested.
    PressureRequested,
    /// Set-point of a regulator, as the board has it.
    PressureSet,
}

/// The parts that a group has a column for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parts {
    Segments,
    BendSensors,
    Regulators,
}

impl Parts {
    fn count(self, size: ArmSize) -> usize {
        match self {
            Self::Segments => size.segments,
            Self::BendSensors => size.segments * SENSOR_NAMES.len(),
            Self::Regulators => size.regulators,
        }
    }

    /// Number of a part in the names of its columns, from 1.
    fn number(self, i: usize) -> String {
        match self {
            Self::BendSensors => format!("{}{}", i / SENSOR_NAMES.len() + 1, SENSOR_NAMES[i % SENSOR_NAMES.len()]),
            Self::Segments | Self::Regulators => (i + 1).to_string(),
        }
    }
}

/// Each group with the prefix and suffix of its columns' names, and its parts.
const GROUPS: [(ColumnGroup, &str, &str, Parts); 19] = [
    (ColumnGroup::Theta, "theta", "_deg", Parts::Segments),
    (ColumnGroup::X, "x", "_mm", Parts::Segments),
    (ColumnGroup::Y, "y", "_mm", Parts::Segments),
    (ColumnGroup::Bend, "bend", "_adc", Parts::BendSensors),
    (ColumnGroup::Imu, "imu", "_deg", Parts::Segments),
    (ColumnGroup::Drift, "drift", "_deg", Parts::Segments),
    (ColumnGroup::InnovationImu, "innovation_imu", "_deg", Parts::Segments),
    (ColumnGroup::InnovationBend, "innovation_bend", "_deg", Parts::Segments),
    (ColumnGroup::ThetaDeviation, "theta", "_deviation_deg", Parts::Segments),
    (ColumnGroup::EndXx, "end", "_xx_mm2", Parts::Segments),
    (ColumnGroup::EndXy, "end", "_xy_mm2", Parts::Segments),
    (ColumnGroup::EndYy, "end", "_yy_mm2", Parts::Segments),
    (ColumnGroup::ContactScore, "contact", "_percent", Parts::Segments),
    (ColumnGroup::InContact, "in_contact", "", Parts::Segments),
    (ColumnGroup::TruthX, "truth", "_x_mm", Parts::Segments),
    (ColumnGroup::TruthY, "truth", "_y_mm", Parts::Segments),
    (ColumnGroup::TruthHeading, "truth", "_heading_deg", Parts::Segments),
    (ColumnGroup::PressureRequested, "pressure", "_requested_kpa", Parts::Regulators),
    (ColumnGroup::PressureSet, "pressure", "_set_kpa", Parts::Regulators),
];

/// Names of the columns of an arm. The time is no column: it is in front of all.
pub(super) fn names(size: ArmSize) -> Vec<String> {
    let of = |(_, prefix, suffix, parts): (ColumnGroup, &str, &str, Parts)| {
        let names: Vec<_> = (0..parts.count(size)).map(|i| format!("{prefix}{}{suffix}", parts.number(i))).collect();
        names
    };
    GROUPS.into_iter().flat_map(of).collect()
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PageRow {
    /// Time since the begin of the session, or of the board's first run, s; it continues over a restart.
    pub time_s: f64,
    /// One value per column; NaN for no value.
    pub values: Vec<f32>,
    pub size: ArmSize,
}

impl PageRow {
    pub fn new(time_s: f64, size: ArmSize) -> Self {
        let columns = GROUPS.iter().map(|(.., parts)| parts.count(size)).sum();
        Self { time_s, values: vec![f32::NAN; columns], size }
    }

    /// Sets the column of one part, from 0, rounded to 10⁻⁴: less than the resolution of any column.
    pub fn set(&mut self, group: ColumnGroup, i: usize, value: Option<f64>) {
        let column = self.first_column(group) + i;
        if let Some(place) = self.values.get_mut(column) {
            *place = value.map_or(f32::NAN, |value| ((value * 1e4).round() / 1e4) as f32);
        }
    }

    fn first_column(&self, group: ColumnGroup) -> usize {
        let groups = GROUPS.iter().take_while(|(other, ..)| *other != group);
        groups.map(|(.., parts)| parts.count(self.size)).sum()
    }

    /// The values of a group with one column for each segment.
    #[cfg(test)]
    pub fn group(&self, group: ColumnGroup) -> &[f32] {
        &self.values[self.first_column(group)..][..self.size.segments]
    }

    /// Sets the raw readings.
    pub fn set_sample<const N: usize>(&mut self, sample: &estimator_core::Sample<N>) {
        for i in 0..self.size.segments.min(N) {
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
        for (i, segment) in segments.iter().enumerate().take(self.size.segments) {
            self.set(ColumnGroup::Theta, i, segment.map(|segment| value(segment.theta).to_degrees()));
            self.set(ColumnGroup::X, i, segment.map(|segment| value(segment.end[0]) * 1e3));
            self.set(ColumnGroup::Y, i, segment.map(|segment| value(segment.end[1]) * 1e3));
        }
    }

    /// Sets the uncertainty and contact of a board.
    pub fn set_uncertainty(&mut self, uncertainty: &Uncertainty) {
        for (i, segment) in uncertainty.segments.iter().enumerate().take(self.size.segments) {
            let variance = segment.theta.map(|bits| Q::from_bits(bits).to_f64() / VARIANCE_SCALE);
            self.set_variances(i, variance, segment.end_m2());
            self.set_contact(i, segment.contact_percent.into(), segment.in_contact);
        }
    }

    /// Sets the variance of θ_i, rad², and the covariance xx, xy, yy of the segment's end, m².
    pub fn set_variances(&mut self, i: usize, theta_rad2: Option<f64>, end_m2: Option<[f64; 3]>) {
        self.set(ColumnGroup::ThetaDeviation, i, theta_rad2.map(|variance| variance.max(0.0).sqrt().to_degrees()));
        let groups = [ColumnGroup::EndXx, ColumnGroup::EndXy, ColumnGroup::EndYy];
        for (j, group) in groups.into_iter().enumerate() {
            self.set(group, i, end_m2.map(|end_m2| end_m2[j] * 1e6));
        }
    }

    /// Sets the contact of one segment.
    pub fn set_contact(&mut self, i: usize, score_percent: u16, in_contact: bool) {
        self.set(ColumnGroup::ContactScore, i, Some(score_percent.into()));
        self.set(ColumnGroup::InContact, i, Some(u8::from(in_contact).into()));
    }

    /// Sets pressures of the regulators, Pa.
    pub fn set_pressures(&mut self, group: ColumnGroup, pressures_pa: &[u32]) {
        for (i, pressure_pa) in pressures_pa.iter().enumerate().take(self.size.regulators) {
            self.set(group, i, Some(f64::from(*pressure_pa) / 1e3));
        }
    }

    /// Sets the true poses of the segments' ends.
    pub fn set_truth(&mut self, ends: &[Option<Truth>]) {
        for (i, end) in ends.iter().enumerate().take(self.size.segments) {
            self.set(ColumnGroup::TruthX, i, end.map(|end| end.x_m * 1e3));
            self.set(ColumnGroup::TruthY, i, end.map(|end| end.y_m * 1e3));
            let heading = end.and_then(|end| end.heading_rad);
            self.set(ColumnGroup::TruthHeading, i, heading.map(f64::to_degrees));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ArmSize, ColumnGroup, PageRow, names};

    #[test]
    fn every_value_is_in_the_column_of_its_name() {
        let size = ArmSize { segments: 3, regulators: 2 };
        let names = names(size);
        let mut row = PageRow::new(0.0, size);
        assert_eq!(names.len(), row.values.len());
        row.set(ColumnGroup::Bend, 3, Some(1234.0));
        row.set(ColumnGroup::TruthHeading, 2, Some(-0.123_456));
        row.set_pressures(ColumnGroup::PressureSet, &[0, 61_500]);
        let set = names.iter().map(String::as_str).zip(row.values).filter(|(_, value)| !value.is_nan());
        let expected = [
            ("bend2b_adc", 1234.0),
            ("truth3_heading_deg", -0.1235),
            ("pressure1_set_kpa", 0.0),
            ("pressure2_set_kpa", 61.5),
        ];
        assert!(set.eq(expected));
    }
}
