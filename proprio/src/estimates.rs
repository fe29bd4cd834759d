//! The estimate CSV: θ and world points of all methods, a row a sample.

use std::io::{self, Write};

use estimator_core::{Method, Scalar, SegmentShape};

use crate::replay::Outcome;

/// Estimates that are being written.
pub struct EstimateWriter<W> {
    sink: W,
}

impl<W: Write> EstimateWriter<W> {
    /// Begins a file for an arm of `segments` segments with its header.
    ///
    /// # Errors
    /// Those of `sink`.
    pub fn new(mut sink: W, segments: usize) -> io::Result<Self> {
        write!(sink, "time_s")?;
        for method in Method::ALL.map(Method::name) {
            for i in 1..=segments {
                write!(sink, ",{method}{i}_theta_deg,{method}{i}_x_mm,{method}{i}_y_mm")?;
            }
        }
        writeln!(sink)?;
        Ok(Self { sink })
    }

    /// Writes one row; the cells of what is not known stay empty.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write<S: Scalar>(&mut self, outcome: &Outcome<S>) -> io::Result<()> {
        write!(self.sink, "{}", outcome.estimate.time_us as f64 / 1e6)?;
        for SegmentShape { theta, end } in outcome.shapes.iter().flatten() {
            match theta {
                Some(theta) => write!(self.sink, ",{:.6}", theta.rad().to_degrees())?,
                None => write!(self.sink, ",")?,
            }
            match end {
                Some(end) => write!(self.sink, ",{:.5},{:.5}", end.x.to_f64() * 1e3, end.y.to_f64() * 1e3)?,
                None => write!(self.sink, ",,")?,
            }
        }
        writeln!(self.sink)
    }

    /// The sink, when all rows are written.
    pub fn into_inner(self) -> W {
        self.sink
    }
}
