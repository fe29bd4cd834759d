//! Rows of a session as CSV, without loss: every reading comes back to the bit.

use std::f64::consts::TAU;
use std::io::{self, Write};

use estimator_core::{ImuReading, SENSORS_PER_SEGMENT};

use crate::{Row, SENSOR_NAMES, TARE, Truth};

/// Form of an IMU's readings in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImuForm {
    /// One column: the heading, rad.
    Heading,
    /// Four columns: w, x, y, z.
    Quaternion,
}

/// The columns of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CsvLayout {
    /// Presence of the bend sensors of each segment.
    pub bend_sensors: Vec<[bool; SENSORS_PER_SEGMENT]>,
    /// Form of the IMUs' readings.
    pub imu: ImuForm,
    /// Columns of truth.
    pub has_truth: bool,
    /// Columns of the truth's headings.
    pub has_true_headings: bool,
}

impl CsvLayout {
    /// Writes the header.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn write_header(&self, sink: &mut impl Write) -> io::Result<()> {
        write!(sink, "time_s,{TARE}")?;
        for (i, present) in (1..).zip(&self.bend_sensors) {
            for (name, _) in SENSOR_NAMES.iter().zip(present).filter(|(_, present)| **present) {
                write!(sink, ",bend{i}{name}_adc")?;
            }
        }
        for i in 1..=self.bend_sensors.len() {
            match self.imu {
                ImuForm::Heading => write!(sink, ",imu{i}_rad")?,
                ImuForm::Quaternion => write!(sink, ",imu{i}_qw,imu{i}_qx,imu{i}_qy,imu{i}_qz")?,
            }
        }
        for i in (1..=self.bend_sensors.len()).take_while(|_| self.has_truth) {
            // m and rad, so that no digit is lost on the way.
            write!(sink, ",truth{i}_x_m,truth{i}_y_m")?;
            if self.has_true_headings {
                write!(sink, ",truth{i}_heading_rad")?;
            }
        }
        writeln!(sink)
    }

    /// Writes one row, with the number of its tare.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn write_row(&self, sink: &mut impl Write, row: &Row, tare: u64) -> io::Result<()> {
        write!(sink, "{},{tare}", row.sample.time_us as f64 / 1e6)?;
        for (counts, present) in row.sample.bend.iter().zip(&self.bend_sensors) {
            for (counts, _) in counts.iter().zip(present).filter(|(_, present)| **present) {
                match counts {
                    Some(counts) => write!(sink, ",{counts}")?,
                    None => write!(sink, ",")?,
                }
            }
        }
        for imu in row.sample.imu.iter().take(self.bend_sensors.len()) {
            self.write_imu(sink, *imu)?;
        }
        for end in row.truth.iter().take(self.bend_sensors.len()).take_while(|_| self.has_truth) {
            match (end, self.has_true_headings) {
                (Some(Truth { x_m, y_m, heading_rad: Some(heading_rad) }), true) => {
                    write!(sink, ",{x_m},{y_m},{heading_rad}")?;
                }
                (Some(Truth { x_m, y_m, .. }), false) => write!(sink, ",{x_m},{y_m}")?,
                // A session has headings of all truth or of none.
                (_, true) => write!(sink, ",,,")?,
                (None, false) => write!(sink, ",,")?,
            }
        }
        writeln!(sink)
    }

    fn write_imu(&self, sink: &mut impl Write, imu: Option<ImuReading>) -> io::Result<()> {
        match (self.imu, imu) {
            (ImuForm::Quaternion, Some(ImuReading::Quaternion(parts))) => {
                // 2⁻³⁰ has a finite decimal form, so that the reading comes back to the bit.
                parts.iter().try_for_each(|part| write!(sink, ",{}", f64::from(*part) / 1_073_741_824.0))
            }
            // Of another form: a board gives no headings.
            (ImuForm::Quaternion, _) => write!(sink, ",,,,"),
            (ImuForm::Heading, imu) => match imu.and_then(|reading| reading.heading()) {
                Some(heading) => write!(sink, ",{}", heading.rad().rem_euclid(TAU)),
                None => write!(sink, ","),
            },
        }
    }
}
