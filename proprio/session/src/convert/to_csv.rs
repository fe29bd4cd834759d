//! A recording's readings as CSV.

use std::io::{self, Write};

use super::samples::WORK;
use crate::recording::HoleTimes;
use crate::{CsvLayout, Error, FileFormat, ImuForm, MissingHistory, Progress, SessionReader};

/// Writes all rows and returns what was left out; `failed` is the error of a row that cannot be written.
pub fn write<W: Write>(
    mut reader: SessionReader,
    sink: &mut W,
    failed: impl Fn(&W, io::Error) -> Error,
    progress: &mut dyn Progress,
) -> Result<Vec<String>, Error> {
    let bend_sensors = reader.bend_sensors().take(reader.segments()).collect();
    let (has_truth, has_true_headings) = (reader.has_truth(), reader.has_true_headings());
    // A board gives no headings.
    let layout = CsvLayout { bend_sensors, imu: ImuForm::Quaternion, has_truth, has_true_headings };
    layout.write_header(sink).map_err(|error| failed(sink, error))?;
    let (mut starts, mut estimates, mut before) = (0_u64, 0_u64, 0_u64);
    let mut missing_history = MissingHistory::default();
    while let Some(row) = reader.next_row()? {
        missing_history.add(&row);
        starts += u64::from(row.starts);
        before += u64::from(!row.is_recorded());
        estimates += u64::from(row.board.as_ref().is_some_and(|board| board.estimate.is_some()));
        layout.write_row(sink, &row, starts.saturating_sub(1)).map_err(|error| failed(sink, error))?;
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
