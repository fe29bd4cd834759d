//! Readings of the sensors, and the motion that they and the camera have measured.

use std::mem;
use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::{ImuReading, SENSORS_PER_SEGMENT};
use proprio_check::clock_fit::{ComparedSensors, Motion, Pair, Reading, Signal};
use proprio_session::{
    FileDefects, FileFormat, Progress, RequiredColumns, Row, SessionError, SessionProblem, SessionReader,
};

use super::angle::unwrap_near;
use super::error::AlignmentError;
use super::frames::Frames;
use crate::error::Error;

/// Readings of a session's sensors, without the missing ones.
pub(super) struct Readings {
    pub times_us: Vec<u64>,
    pub defects: FileDefects,
    pub kind: FileFormat,
    /// Starts of the board's runs, s, at which an IMU's heading has a new zero.
    starts_s: Vec<f64>,
    imu: Vec<Vec<Reading>>,
    bend: Vec<[Vec<Reading>; SENSORS_PER_SEGMENT]>,
}

impl Readings {
    pub fn read(session: &Path, arm: &ArmFile, progress: &mut dyn Progress) -> Result<Self, Error> {
        let needs = RequiredColumns { truth: false, ..RequiredColumns::of_calibration(arm) };
        let mut reader = SessionReader::open(session, &needs)?;
        let refuse = |line, problem| SessionError { path: session.to_owned(), line, column: None, problem };
        if !reader.is_regular_file() {
            return Err(refuse(None, SessionProblem::NotAFile).into());
        }
        if let Some(column) = reader.truth_column() {
            return Err(refuse(Some(1), SessionProblem::HasTruth(format!("column {column}"))).into());
        }
        if reader.has_truth() {
            return Err(refuse(None, SessionProblem::HasTruth("truth".to_owned())).into());
        }
        let n = arm.segments.len();
        let mut readings = Self {
            times_us: Vec::new(),
            defects: reader.defects(),
            kind: reader.kind(),
            starts_s: Vec::new(),
            imu: vec![Vec::new(); n],
            bend: vec![Default::default(); n],
        };
        let work = format!("reading {}", session.display());
        while let Some(row) = reader.next_row()? {
            readings.push(&row);
            progress.advance(&work, reader.progress());
        }
        Ok(readings)
    }

    fn push(&mut self, row: &Row) {
        let Row { sample, .. } = row;
        self.times_us.push(sample.time_us);
        let time_s = self.since_start_s(sample.time_us);
        self.starts_s.extend(row.starts.then_some(time_s));
        for ((imu, bend), (imu_read, bend_read)) in
            self.imu.iter_mut().zip(&mut self.bend).zip(sample.imu.iter().zip(&sample.bend))
        {
            if let Some(heading) = imu_read.as_ref().and_then(ImuReading::heading) {
                imu.push((time_s, heading.rad()));
            }
            for (sensor, counts) in bend.iter_mut().zip(bend_read) {
                sensor.extend(counts.map(|counts| (time_s, f64::from(counts))));
            }
        }
    }

    /// Time of the first row.
    pub fn first_us(&self) -> u64 {
        self.times_us.first().copied().unwrap_or_default()
    }

    /// Time since the first row.
    pub fn since_start_s(&self, time_us: u64) -> f64 {
        (time_us - self.first_us()) as f64 / 1e6
    }

    /// Time from the first row to the last, s.
    pub fn seconds(&self) -> f64 {
        self.times_us.last().map_or(0.0, |last_us| self.since_start_s(*last_us))
    }
}

/// The motion by IMUs where there are any, as they have the least lag and memory; else by bend sensors.
///
/// Takes the readings' columns out of `readings`, as they are large.
pub(super) fn motion(readings: &mut Readings, frames: &Frames) -> Result<Motion, AlignmentError> {
    let imus = mem::take(&mut readings.imu).into_iter().map(unwrapped).enumerate();
    let bend =
        mem::take(&mut readings.bend).into_iter().enumerate().flat_map(|(i, pair)| pair.map(|sensor| (i, sensor)));
    let (imus, bend) = (seen(imus), seen(bend));
    let by = if imus.is_empty() { ComparedSensors::Bend } else { ComparedSensors::Imus };
    let (sensors, cameras, starts_s) = match by {
        ComparedSensors::Imus => (imus, frames.headings(), &readings.starts_s[..]),
        ComparedSensors::Bend => (bend, frames.bends(), &[][..]),
    };
    let pairs: Vec<Pair> =
        sensors.into_iter().map(|(camera, read)| Pair { sensor: Signal::new(&read, starts_s), camera }).collect();
    if pairs.is_empty() {
        return Err(AlignmentError::NoSensors);
    }
    Ok(Motion { pairs, cameras: cameras.iter().map(|seen| Signal::new(seen, &[])).collect(), by })
}

/// The columns that have readings.
fn seen(columns: impl Iterator<Item = (usize, Vec<Reading>)>) -> Vec<(usize, Vec<Reading>)> {
    columns.filter(|(_, readings)| !readings.is_empty()).collect()
}

/// Unwraps headings.
fn unwrapped(mut headings: Vec<Reading>) -> Vec<Reading> {
    let mut last = 0.0;
    for (_, heading) in &mut headings {
        *heading = unwrap_near(*heading, last);
        last = *heading;
    }
    headings
}
