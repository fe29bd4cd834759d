//! `align` on a camera's file with faults: they are named by the frames' times, and are not in the truth that it writes.

use super::common::Csv;
use super::recordings::{Aligned, Recording};
use super::truth_faults::{exchange, number, parts, shift, zeros};

/// The aligned session after `edit` of the camera's file, with what the tool wrote on stderr.
fn aligned(edit: impl FnOnce(&mut Csv)) -> (Csv, String) {
    let mut recording = Recording::short();
    edit(&mut recording.camera);
    let aligned: Aligned = recording.align();
    (aligned.csv(), aligned.run.stderr)
}

/// Largest distance of a true place from that of the good alignment, mm, and the number of rows without one.
fn compared(found: &Csv, segment: usize) -> (f64, usize) {
    let good = aligned(|_| {}).0;
    let [x, y, _] = parts(segment);
    let (mut most_mm, mut empty) = (0.0, 0);
    for row in 0..good.rows.len() {
        let known = |csv: &Csv| !csv.cell(row, &x).is_empty();
        if !known(&good) || !known(found) {
            empty += usize::from(known(&good));
            continue;
        }
        let difference = |name: &str| number(found.cell(row, name)) - number(good.cell(row, name));
        most_mm = f64::max(most_mm, difference(&x).hypot(difference(&y)));
    }
    (most_mm, empty)
}

/// Whole frames in which each marker was seen.
fn whole(camera: &Csv, frames: std::ops::Range<usize>) -> Vec<usize> {
    frames.filter(|frame| camera.rows[*frame].iter().all(|cell| !cell.is_empty())).collect()
}

#[test]
fn a_good_camera_has_no_warning_and_its_lengths_are_printed() {
    let aligned = Recording::short().align();
    assert_eq!(aligned.run.warnings(), Vec::<&str>::new());
    let scale = aligned.numbers("lengths")[0];
    assert!((scale - 1.0).abs() < 0.01, "{}", aligned.run.stdout);
}

/// The base's marker turns and shifts the poses: zeros are those of the camera's frame.
#[test]
fn zeros_of_a_lost_marker_are_not_in_the_truth() {
    let (csv, stderr) = aligned(|camera| zeros(camera, 4, (2000..8000).step_by(1000)));
    assert!(stderr.contains("warning: camera.csv: truth4, 6 of rows 2001 to 7001"), "{stderr}");
    let (most_mm, _) = compared(&csv, 4);
    assert!(most_mm < 10.0, "{most_mm} mm");
}

/// Places and headings do not turn the same way.
#[test]
fn a_mirrored_axis_of_the_camera_is_a_warning() {
    let (_, stderr) = aligned(|camera| {
        for name in (1..=6).map(|segment| format!("truth{segment}_x_mm")).chain(["base_x_mm".to_owned()]) {
            camera.map(&name, |_, cell| if cell.is_empty() { String::new() } else { (-number(cell)).to_string() });
        }
    });
    assert!(stderr.contains("warning: camera.csv: truth, "), "{stderr}");
}

#[test]
fn exchanged_names_are_not_in_the_truth() {
    let mut count = 0;
    let (csv, stderr) = aligned(|camera| {
        let frames = whole(camera, 4000..4300);
        count = frames.len();
        exchange(camera, [2, 3], frames);
    });
    assert!(count > 200 && stderr.contains(&format!("truth2 and truth3, {count} of rows ")), "{count}: {stderr}");
    let (most_mm, _) = compared(&csv, 2);
    assert!(most_mm < 10.0, "{most_mm} mm");
}

#[test]
fn a_place_beyond_the_arms_length_is_not_in_the_truth() {
    let (csv, stderr) = aligned(|camera| {
        let frames = whole(camera, 4000..4100);
        shift(camera, 5, frames, 150.0);
    });
    assert!(stderr.contains("warning: camera.csv: truth5, "), "{stderr}");
    let (most_mm, empty) = compared(&csv, 5);
    assert!(most_mm < 10.0 && empty > 10, "{most_mm} mm, {empty} rows");
}

/// Single held frames are shorter than the time over which the truth is interpolated.
#[test]
fn a_marker_that_is_held_is_not_in_the_truth() {
    let (csv, stderr) = aligned(|camera| {
        let frames = whole(camera, 4000..4150);
        let first = frames[0];
        for name in parts(6) {
            let cell = camera.cell(first, &name).to_owned();
            for frame in &frames {
                camera.set(*frame, &name, &cell);
            }
        }
    });
    assert!(stderr.contains("truth6, ") && stderr.contains("repeated while the arm moves"), "{stderr}");
    let (most_mm, _) = compared(&csv, 6);
    assert!(most_mm < 15.0, "{most_mm} mm");
}

#[test]
fn places_in_metres_are_refused() {
    let mut recording = Recording::short();
    for name in recording.camera.names.clone().iter().filter(|name| name.ends_with("_mm")) {
        recording.camera.map(
            name,
            |_, cell| {
                if cell.is_empty() { String::new() } else { (number(cell) * 0.001).to_string() }
            },
        );
    }
    let error = recording.refused();
    assert!(error.ends_with("the places are in metres, in columns of mm"), "{error}");
}
