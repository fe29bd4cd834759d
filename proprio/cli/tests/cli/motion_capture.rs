//! `align` on the exports of motion-capture programs: the same run of the twin in each program's form.

use std::fmt::Write as _;

use super::common::{Csv, Folder, arm};
use super::recordings::{Recording, args};

const SEGMENTS: usize = 6;
/// Where the capture volume has the origin of the camera's frame, m, and its y axis, clockwise from the volume's, rad.
const ORIGIN_M: [f64; 2] = [1.25, -0.4];
const TURNED_RAD: f64 = 2.2;

/// A body's place in the capture volume, m, and its heading since it was made, clockwise, rad.
type BodyPose = Option<[f64; 3]>;

/// Times of the frames, s, and the bodies: the base and the segments' ends.
fn bodies(camera: &Csv) -> Vec<(f64, Vec<BodyPose>)> {
    let number = |row: usize, name: String| camera.cell(row, &name).parse::<f64>().ok();
    let start_s = number(0, "time_s".to_owned()).expect("a time");
    let pose = |row: usize, of: &str| -> BodyPose {
        let [x, y] = ["x_mm", "y_mm"].map(|part| number(row, format!("{of}_{part}")));
        let heading = number(row, format!("{of}_heading_deg"))?.to_radians();
        Some(in_volume(x? / 1e3, y? / 1e3, heading))
    };
    let frame = |row: usize| {
        let ends = (1..=SEGMENTS).map(|i| pose(row, &format!("truth{i}")));
        let time_s = number(row, "time_s".to_owned()).expect("a time") - start_s;
        (time_s, std::iter::once(pose(row, "base")).chain(ends).collect())
    };
    (0..camera.rows.len()).map(frame).collect()
}

fn in_volume(x_m: f64, y_m: f64, heading: f64) -> [f64; 3] {
    let (sin, cos) = TURNED_RAD.sin_cos();
    [ORIGIN_M[0] + x_m * cos + y_m * sin, ORIGIN_M[1] - x_m * sin + y_m * cos, heading]
}

fn name(body: usize) -> String {
    if body == 0 { "Base".to_owned() } else { format!("S{body}") }
}

/// Motive: m, y up, quaternions; headings in the file are counter-clockwise.
fn motive(frames: &[(f64, Vec<BodyPose>)]) -> String {
    let row = |of: &dyn Fn(usize) -> [String; 7]| (0..=SEGMENTS).flat_map(of).collect::<Vec<_>>().join(",");
    let all = |text: &str| std::array::from_fn(|_| text.to_owned());
    let kinds = ["Rotation", "Rotation", "Rotation", "Rotation", "Position", "Position", "Position"];
    let axes = ["X", "Y", "Z", "W", "X", "Y", "Z"];
    let mut text = format!(
        "Format Version,1.23,Take Name,arm,Rotation Type,Quaternion,Length Units,Meters\n\n,,{}\n,,{}\n,,{}\nFrame,Time (Seconds),{}\n",
        row(&|_| all("Rigid Body")),
        row(&|body| all(&name(body))),
        row(&|_| kinds.map(str::to_owned)),
        row(&|_| axes.map(str::to_owned)),
    );
    for (k, (time_s, poses)) in frames.iter().enumerate() {
        let cells = |body: usize| match poses[body] {
            Some([x, y, heading]) => {
                let half = -heading / 2.0;
                [0.0, half.sin(), 0.0, half.cos(), x, 0.8, -y].map(|number| format!("{number:.6}"))
            }
            None => all(""),
        };
        writeln!(text, "{k},{time_s:.6},{}", row(&cells)).expect("a string takes all");
    }
    text
}

/// Vicon: mm, degrees, z up, frames by their numbers.
fn vicon(frames: &[(f64, Vec<BodyPose>)], rate_hz: f64) -> String {
    let repeated = |of: &str| [of; SEGMENTS + 1].join(",");
    let names = (0..=SEGMENTS).map(|body| format!("Arm:{},,,,,", name(body))).collect::<Vec<_>>().join(",");
    let mut text = format!(
        "Segments\n{rate_hz}\n,,{names}\nFrame,Sub Frame,{}\n,,{}\n",
        repeated("RX,RY,RZ,TX,TY,TZ"),
        repeated("deg,deg,deg,mm,mm,mm"),
    );
    for (time_s, poses) in frames {
        let cells = poses.iter().map(|pose| match pose {
            Some([x, y, heading]) => {
                format!("0,0,{:.4},{:.3},{:.3},800", -heading.to_degrees(), x * 1e3, y * 1e3)
            }
            None => ",,,,,".to_owned(),
        });
        let cells = cells.collect::<Vec<_>>().join(",");
        writeln!(text, "{:.0},0,{cells}", time_s * rate_hz).expect("a string takes all");
    }
    text
}

/// Truth of two aligned sessions: the largest distance of a segment's end, mm, and between headings, degrees.
fn difference(a: &Csv, b: &Csv) -> [f64; 2] {
    let mut largest = [0.0_f64; 2];
    for row in 0..a.rows.len() {
        for i in 1..=SEGMENTS {
            let number = |csv: &Csv, part: &str| csv.cell(row, &format!("truth{i}_{part}")).parse::<f64>().ok();
            let apart = |part: &str| Some((number(a, part)? - number(b, part)?).abs());
            let [x, y, heading] = ["x_mm", "y_mm", "heading_deg"].map(apart);
            largest[0] = largest[0].max(x.unwrap_or_default()).max(y.unwrap_or_default());
            largest[1] = largest[1].max(heading.unwrap_or_default());
        }
    }
    largest
}

fn aligned(recording: &Recording, export: &str, more: &[&str]) -> (Folder, String) {
    let folder = Folder::with("session.csv", recording.session.to_string());
    folder.write("camera.csv", export);
    let run = folder.done(&[&args(arm())[..], more].concat());
    (folder, run.stdout)
}

/// The twin's arm rests 0.3° off straight in each segment, and its markers have noise, which the straight pose does not know.
#[test]
fn exports_give_the_truth_of_the_markers_within_what_the_straight_pose_is_worth() {
    let recording = Recording::short();
    let direct = recording.align().csv();
    let frames = bodies(&recording.camera);
    for (program, export) in [("Motive", motive(&frames)), ("Vicon", vicon(&frames, 10_000.0))] {
        let (folder, text) = aligned(&recording, &export, &[]);
        assert!(
            text.contains("Base, S1, S2, S3, S4, S5, S6") || text.contains("Arm:Base, Arm:S1"),
            "{program}: {text}"
        );
        let [mm, deg] = difference(&direct, &folder.csv("aligned.csv"));
        assert!(mm < 12.0 && deg < 1.5, "{program}: {mm} mm, {deg}°");
    }
}

#[test]
fn bodies_in_a_wrong_order_are_refused() {
    let recording = Recording::short();
    let export = motive(&bodies(&recording.camera));
    let folder = Folder::with("session.csv", recording.session.to_string());
    folder.write("camera.csv", export);
    let error = folder.refused(&[&args(arm())[..], &["--bodies", "Base,S3,S2,S1,S4,S5,S6"]].concat());
    assert!(error.starts_with("camera.csv: in the first second the bodies are"), "{error}");
}

#[test]
fn an_arm_that_moves_as_the_capture_starts_is_refused() {
    let mut recording = Recording::short();
    recording.keep_frames(|time_s| time_s > 20.0);
    let folder = Folder::with("session.csv", recording.session.to_string());
    folder.write("camera.csv", motive(&bodies(&recording.camera)));
    let error = folder.refused(&args(arm()));
    assert!(error.contains("in the first second"), "{error}");
}
