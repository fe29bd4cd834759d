//! The file of the twin's truth: a row every 10 ms.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use virtual_due::rig::WiredRig;
use virtual_due::{CYCLES_PER_SECOND, Cycles};

/// Time between rows: the firmware's own period.
const PERIOD: Cycles = CYCLES_PER_SECOND / 100;

/// A CSV file of true poses and of set-points of the regulators.
pub struct TruthFile {
    file: BufWriter<File>,
    next: Cycles,
}

impl TruthFile {
    /// Creates the file with its line of column names, those of sessions for the poses.
    ///
    /// # Errors
    /// Those of the file.
    pub fn create(path: &Path, rig: &WiredRig) -> io::Result<Self> {
        let mut file = BufWriter::new(File::create(path)?);
        write!(file, "time_s")?;
        for segment in 1..=rig.truth().len() {
            write!(file, ",truth{segment}_x_mm,truth{segment}_y_mm,truth{segment}_heading_deg")?;
        }
        for regulator in 1..=rig.set_points_pa().len() {
            write!(file, ",setpoint{regulator}_kpa")?;
        }
        writeln!(file)?;
        Ok(Self { file, next: 0 })
    }

    /// Writes the row of `now`, if it is due.
    ///
    /// # Errors
    /// Those of the file.
    pub fn write(&mut self, now: Cycles, rig: &mut WiredRig) -> io::Result<()> {
        if now < self.next {
            return Ok(());
        }
        self.next = now + PERIOD;
        rig.advance_to(now);
        write!(self.file, "{:.3}", now as f64 / CYCLES_PER_SECOND as f64)?;
        for pose in &rig.truth() {
            let (x_mm, y_mm) = (1000.0 * pose.x_m, 1000.0 * pose.y_m);
            write!(self.file, ",{x_mm:.3},{y_mm:.3},{:.4}", pose.heading_rad.to_degrees())?;
        }
        for pascals in &rig.set_points_pa() {
            write!(self.file, ",{:.3}", pascals / 1000.0)?;
        }
        writeln!(self.file)
    }

    /// Writes what is buffered.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
