//! Sessions as CSV: their header, their rows and their errors.
//!
//! The first byte of an input selects the columns that are required.

use std::fmt::Write;
use std::path::Path;

use calibration_tables::MAX_SEGMENTS;
use estimator_core::ImuReading;
use proprio_session::{Header, RequiredColumns, Row, SessionError, SessionReader, TARE};

use crate::input_file::{check_error, with_file};

/// Largest ADC counts.
const MAX_COUNTS: u16 = 4095;

/// Units of a quaternion's parts in 1.
const QUATERNION_ONE: f64 = 1_073_741_824.0;

/// Reads a text as the session of an arm.
///
/// # Panics
/// Where accepted rows, written again, are not read as the same rows; where times go backwards; where a reading is out of
/// its range; and where an error has no line of the text.
pub fn session_csv(bytes: &[u8]) {
    let Some((first, text)) = bytes.split_first() else { return };
    let segments = usize::from(first % 16) + 1;
    let needs = RequiredColumns { bend: vec![None; segments], truth: first & 0x10 != 0 };
    let read = with_file(".csv", text, |path| {
        // Its segments are those of the text, and may be any number.
        let _ = Header::of(path).inspect_err(|error| check_error(error, text));
        session(path, &needs)
    });
    match read {
        Ok(session) => {
            check(&session.rows);
            let written = session.text(segments, needs.truth);
            let again = with_file(".csv", written.as_bytes(), |path| self::session(path, &needs));
            assert_eq!(again.unwrap_or_else(|error| panic!("{error}: {written}")), session, "{written}");
        }
        Err(error) => check_error(&error, text),
    }
}

/// The content of a session.
#[derive(Debug, PartialEq)]
struct Session {
    bend_sensors: Vec<[bool; 2]>,
    rows: Vec<Row>,
}

fn session(path: &Path, needs: &RequiredColumns) -> Result<Session, SessionError> {
    let mut reader = SessionReader::open(path, needs)?;
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row()? {
        rows.push(row);
    }
    let rate = reader.rate_hz(100.0);
    assert!(rate.is_err() || rate.is_ok_and(|rate| rate > 0.0 && rate.is_finite()), "the rate of {} rows", rows.len());
    Ok(Session { bend_sensors: reader.bend_sensors().collect(), rows })
}

fn check(rows: &[Row]) {
    assert!(rows.iter().is_sorted_by_key(|row| row.sample.time_us), "times go backwards");
    let counts = rows.iter().flat_map(|row| row.sample.bend.as_flattened()).flatten();
    assert!(counts.max().is_none_or(|counts| *counts <= MAX_COUNTS));
    let truth = rows.iter().flat_map(|row| &row.truth).flatten();
    assert!(truth.map(|end| end.x_m + end.y_m + end.heading_rad.unwrap_or(0.0)).all(f64::is_finite));
}

impl Session {
    /// The session in one form of many: metres, radians, and a column for each reading that there is.
    fn text(&self, segments: usize, needs_truth: bool) -> String {
        let ends = |i: usize| self.rows.iter().filter_map(move |row| row.truth[i]);
        let has_headings = needs_truth || (0..segments).any(|i| ends(i).any(|end| end.heading_rad.is_some()));
        let has_truth: Vec<bool> = (0..segments).map(|i| has_headings || ends(i).next().is_some()).collect();
        let is_heading = |i: usize| {
            let mut readings = self.rows.iter().filter_map(|row| row.sample.imu[i]);
            readings.any(|reading| matches!(reading, ImuReading::Heading(_)))
        };
        let headings: Vec<bool> = (0..segments).map(is_heading).collect();
        let mut text = format!("time_s,{TARE}");
        let mut column = |of: &str, i: usize, part: &str| {
            write!(text, ",{of}{}{part}", i + 1).expect("memory takes it");
        };
        for i in 0..segments {
            for (name, _) in ["a_adc", "b_adc"].iter().zip(self.bend_sensors[i]).filter(|(_, present)| *present) {
                column("bend", i, name);
            }
            for part in if headings[i] { &["_rad"][..] } else { &["_qw", "_qx", "_qy", "_qz"] } {
                column("imu", i, part);
            }
            let truth = if has_headings { &["_x_m", "_y_m", "_heading_rad"][..] } else { &["_x_m", "_y_m"] };
            for part in truth.iter().filter(|_| has_truth[i]) {
                column("truth", i, part);
            }
        }
        let mut starts = 0;
        for row in &self.rows {
            starts += u32::from(row.starts);
            write!(text, "\n{},{starts}", row.sample.time_us as f64 / 1e6).expect("memory takes it");
            for i in 0..segments {
                self.write_segment(&mut text, row, i, headings[i], has_truth[i].then_some(has_headings));
            }
        }
        text + "\n"
    }

    /// Writes the cells of a segment; `truth`: with headings or without, where it has columns of truth.
    fn write_segment(&self, text: &mut String, row: &Row, i: usize, is_heading: bool, truth: Option<bool>) {
        let mut cell = |value: Option<f64>| {
            write!(text, ",{}", value.map_or_else(String::new, |value| value.to_string())).expect("memory takes it");
        };
        let sensors = row.sample.bend[i].into_iter().zip(self.bend_sensors[i]).filter(|(_, present)| *present);
        sensors.for_each(|(counts, _)| cell(counts.map(f64::from)));
        match row.sample.imu[i] {
            Some(ImuReading::Heading(phase)) => cell(Some(phase.rad().rem_euclid(std::f64::consts::TAU))),
            Some(ImuReading::Quaternion(parts)) => {
                for part in parts {
                    cell(Some(f64::from(part) / QUATERNION_ONE));
                }
            }
            None => (0..if is_heading { 1 } else { 4 }).for_each(|_| cell(None)),
        }
        if let Some(has_headings) = truth {
            let end = row.truth[i];
            cell(end.map(|end| end.x_m));
            cell(end.map(|end| end.y_m));
            (0..u8::from(has_headings)).for_each(|_| cell(end.and_then(|end| end.heading_rad)));
        }
    }
}

/// Every arm of an input has room.
const _: () = assert!(MAX_SEGMENTS >= 16);
