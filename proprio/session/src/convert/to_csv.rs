//! A recording's readings as CSV.

use std::io::{self, Write};

use estimator_core::{ImuReading, SENSORS_PER_SEGMENT};

use super::samples::WORK;
use crate::recording::HoleTimes;
use crate::{Error, FileFormat, MissingHistory, Progress, Row, SENSOR_NAMES, SessionReader, TARE, Truth};

/// The columns of the file.
struct Layout {
    bend_sensors: Vec<[bool; SENSORS_PER_SEGMENT]>,
    has_truth: bool,
    has_true_headings: bool,
}

/// Writes all rows and returns what was left out; `failed` is the error of a row that cannot be written.
pub fn write(
    mut reader: SessionReader,
    sink: &mut impl Write,
    failed: impl Fn(io::Error) -> Error,
    progress: &mut dyn Progress,
) -> Result<Vec<String>, Error> {
    let bend_sensors = reader.bend_sensors().take(reader.segments()).collect();
    let (has_truth, has_true_headings) = (reader.has_truth(), reader.has_true_headings());
    let layout = Layout { bend_sensors, has_truth, has_true_headings };
    layout.write_header(sink).map_err(&failed)?;
    let (mut starts, mut estimates, mut before) = (0_u64, 0_u64, 0_u64);
    let mut missing_history = MissingHistory::default();
    while let Some(row) = reader.next_row()? {
        missing_history.add(&row);
        starts += u64::from(row.starts);
        before += u64::from(!row.is_recorded());
        estimates += u64::from(row.board.as_ref().is_some_and(|board| board.estimate.is_some()));
        layout.write_row(sink, &row, starts.saturating_sub(1)).map_err(&failed)?;
        progress.advance(WORK, reader.progress());
    }
    let arrival = if reader.kind() == FileFormat::Recording { ", the times of arrival" } else { "" };
    let mut left_out =
        vec![format!("the board's events, uncertainties and health{arrival} and the bytes themselves are left out")];
    if estimates > 0 {
        left_out.push(format!("the board's {estimates} estimates are left out; `proprio replay` makes them again"));
    }
    if before > 0 {
        left_out.push(format!(
            "the first {before} rows are from before the begin of the recording: the tare that its estimates need"
        ));
    }
    left_out.extend(missing_history.is_any().then(|| missing_history.to_string()));
    left_out.extend(reader.defects().holes.iter().map(HoleTimes::to_string));
    Ok(left_out)
}

impl Layout {
    fn write_header(&self, sink: &mut impl Write) -> io::Result<()> {
        write!(sink, "time_s,{TARE}")?;
        for (i, present) in (1..).zip(&self.bend_sensors) {
            for (name, _) in SENSOR_NAMES.iter().zip(present).filter(|(_, present)| **present) {
                write!(sink, ",bend{i}{name}_adc")?;
            }
        }
        for i in 1..=self.bend_sensors.len() {
            write!(sink, ",imu{i}_qw,imu{i}_qx,imu{i}_qy,imu{i}_qz")?;
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

    fn write_row(&self, sink: &mut impl Write, row: &Row, tare: u64) -> io::Result<()> {
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
            match imu {
                Some(ImuReading::Quaternion(parts)) => {
                    // 2⁻³⁰ has a finite decimal form, so that the reading comes back to the bit.
                    parts.iter().try_for_each(|part| write!(sink, ",{}", f64::from(*part) / 1_073_741_824.0))?;
                }
                // A board gives no headings.
                Some(ImuReading::Heading(_)) | None => write!(sink, ",,,,")?,
            }
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
}
