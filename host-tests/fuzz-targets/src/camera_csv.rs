//! A camera's file, the input of an alignment.
//!
//! The first byte of an input is the number of segments.

use std::fmt::Write;
use std::path::Path;

use proprio_session::{BodySelection, CameraFrame, CameraReader, Pose, SessionError};

use crate::input_file::{check_error, with_file};

/// Reads a text as a camera's file.
///
/// # Panics
/// Where accepted frames, written again, are not read as the same frames; where times go backwards; where a pose is not
/// finite; and where an error has no line of the text.
pub fn camera_csv(bytes: &[u8]) {
    let Some((first, text)) = bytes.split_first() else { return };
    let segments = usize::from(first % 16) + 1;
    match with_file(".csv", text, |path| frames(path, segments)) {
        Ok((has_base, frames)) => {
            assert!(frames.iter().is_sorted_by(|a, b| a.time_s <= b.time_s), "times go backwards");
            let poses = frames.iter().flat_map(|frame| frame.ends.iter().chain([&frame.base])).flatten();
            assert!(poses.map(|pose| pose.x_m + pose.y_m + pose.heading_rad).all(f64::is_finite));
            let written = written(&frames, has_base, segments);
            let again = with_file(".csv", written.as_bytes(), |path| self::frames(path, segments));
            assert_eq!(again.unwrap_or_else(|error| panic!("{error}: {written}")), (has_base, frames));
        }
        Err(error) => check_error(&error, text),
    }
}

/// All frames, and true where there are columns of the base.
fn frames(path: &Path, segments: usize) -> Result<(bool, Vec<CameraFrame>), SessionError> {
    let mut reader = CameraReader::open(path, segments, &BodySelection::default())?;
    let mut frames = Vec::new();
    while let Some(frame) = reader.next_frame()? {
        frames.push(frame);
    }
    Ok((reader.has_base(), frames))
}

/// The frames in metres and radians.
fn written(frames: &[CameraFrame], has_base: bool, segments: usize) -> String {
    let markers = has_base.then(|| "base".to_owned()).into_iter().chain((1..=segments).map(|i| format!("truth{i}")));
    let mut text = "time_s".to_owned();
    for marker in markers {
        write!(text, ",{marker}_x_m,{marker}_y_m,{marker}_heading_rad").expect("memory takes it");
    }
    for frame in frames {
        write!(text, "\n{}", frame.time_s).expect("memory takes it");
        let base = has_base.then_some(&frame.base);
        for pose in base.into_iter().chain(&frame.ends[..segments]) {
            text += &pose.map_or_else(
                || ",,,".to_owned(),
                |Pose { x_m, y_m, heading_rad }| format!(",{x_m},{y_m},{heading_rad}"),
            );
        }
    }
    text + "\n"
}
