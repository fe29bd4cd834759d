//! The estimate CSV: θ and world points of all methods, and of the smoothed shape, one row per sample.

use std::io::{self, Write};

use calibration_tables::ArmFile;
use estimator_core::{FusedOps, Method, SegmentShape};
use proprio_session::{Error, OutputFile, WrittenFile};

use crate::Outcome;
use crate::decimal::write_decimal;

/// Writer of estimates.
pub struct EstimateWriter {
    file: OutputFile,
}

impl EstimateWriter {
    /// Begins `file` with the header for the table's segments, and for smoothed estimates where there are any.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn new(mut file: OutputFile, table: &ArmFile, is_smoothed: bool) -> Result<Self, Error> {
        write_header(&mut file, table.segments.len(), is_smoothed).map_err(|error| file.error(error))?;
        Ok(Self { file })
    }

    /// Writes one row; cells of unknown values stay empty.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn write<S: FusedOps>(&mut self, outcome: &Outcome<S>) -> Result<(), Error> {
        write_row(&mut self.file, outcome).map_err(|error| self.file.error(error))
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Output`] and [`Error::Exists`].
    pub fn finish(self) -> Result<WrittenFile, Error> {
        self.file.finish()
    }
}

/// Writes the header for an arm of `segments` segments.
///
/// # Errors
/// Errors of `sink`.
pub fn write_header(sink: &mut impl Write, segments: usize, is_smoothed: bool) -> io::Result<()> {
    write!(sink, "time_s")?;
    for method in Method::ALL.map(Method::name).into_iter().chain(is_smoothed.then_some("smoothed")) {
        for i in 1..=segments {
            write!(sink, ",{method}{i}_theta_deg,{method}{i}_x_mm,{method}{i}_y_mm")?;
        }
    }
    writeln!(sink)
}

/// Writes one row.
///
/// # Errors
/// Errors of `sink`.
pub fn write_row<S: FusedOps>(sink: &mut impl Write, outcome: &Outcome<S>) -> io::Result<()> {
    write!(sink, "{}", outcome.estimate.time_us as f64 / 1e6)?;
    let smoothed = outcome.smoothed.as_ref().map(|smoothed| &smoothed.shape);
    for SegmentShape { theta, end } in outcome.shapes.iter().chain(smoothed).flatten() {
        sink.write_all(b",")?;
        if let Some(theta) = theta {
            write_decimal::<6>(sink, theta.rad().to_degrees())?;
        }
        let [x_mm, y_mm] =
            [end.map(|end| end.x), end.map(|end| end.y)].map(|part| part.map(|part| part.to_f64() * 1e3));
        for part in [x_mm, y_mm] {
            sink.write_all(b",")?;
            if let Some(part) = part {
                write_decimal::<5>(sink, part)?;
            }
        }
    }
    writeln!(sink)
}
