//! Small exports of each program, as its manual and public files have them.

use std::path::Path;

use super::{Axis, BodySelection, MotionCaptureProblem};
use crate::{CameraFrame, CameraReader, SessionError, SessionProblem};

/// Motive 3: two rigid bodies with a marker of one of them, metres, quaternions, y up; the second body is lost in frame 1.
const MOTIVE: &str = include_str!("../../../../host-tests/motion-capture/motive.csv");

/// Vicon Tracker: a section of trajectories before that of the objects; mm and degrees, z up; zeros and empty cells are lost objects.
const VICON: &str = include_str!("../../../../host-tests/motion-capture/vicon.csv");

/// Qualisys Track Manager: mm, a matrix column by column, z up, a tab at the end of each row.
const QUALISYS: &str = include_str!("../../../../host-tests/motion-capture/qualisys.tsv");

fn frames(text: &str, selection: &BodySelection) -> Result<Vec<CameraFrame>, SessionError> {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("export.csv");
    std::fs::write(&path, text).expect("the folder can be written");
    read(&path, selection)
}

fn read(path: &Path, selection: &BodySelection) -> Result<Vec<CameraFrame>, SessionError> {
    let mut reader = CameraReader::open(path, 1, selection)?;
    let mut frames = Vec::new();
    while let Some(frame) = reader.next_frame()? {
        frames.push(frame);
    }
    Ok(frames)
}

fn refused(text: &str, selection: &BodySelection) -> MotionCaptureProblem {
    match frames(text, selection).expect_err("the export is refused").problem {
        SessionProblem::MotionCapture(problem) => *problem,
        other => panic!("{other}"),
    }
}

fn names(names: &[&str]) -> BodySelection {
    BodySelection { names: names.iter().map(|name| (*name).to_owned()).collect(), up: None }
}

/// The base is at 100, 200 mm; the tip 100 mm ahead of it, turned by 30° counter-clockwise, and 97 mm ahead in the last frame.
#[test]
fn poses_are_those_in_the_plane_seen_from_above_with_clockwise_headings() {
    for (program, text, lost) in [("Motive", MOTIVE, &[1][..]), ("Vicon", VICON, &[1, 2]), ("Qualisys", QUALISYS, &[1])]
    {
        let frames = frames(text, &BodySelection::default()).expect("it is read");
        let base = frames[0].base.expect("the base is seen");
        let tip = frames[0].ends[0].expect("the tip is seen");
        assert!((base.x_m - 0.1).abs() < 1e-9 && (base.y_m - 0.2).abs() < 1e-9, "{program}: {base:?}");
        assert!((tip.x_m - 0.1).abs() < 1e-9 && (tip.y_m - 0.3).abs() < 1e-9, "{program}: {tip:?}");
        assert!((tip.heading_rad.to_degrees() + 30.0).abs() < 1e-3, "{program}: {tip:?}");
        for (k, frame) in frames.iter().enumerate() {
            assert_eq!(frame.ends[0].is_none(), lost.contains(&k), "{program}, frame {k}");
        }
    }
}

#[test]
fn times_are_the_columns_or_the_frames_over_the_rate() {
    let times_s = |text| -> Vec<String> {
        let frames = frames(text, &BodySelection::default()).expect("it is read");
        frames.iter().map(|frame| frame.time_s.to_string()).collect()
    };
    assert_eq!(times_s(MOTIVE), ["0", "0.008333", "0.016667"]);
    assert_eq!(times_s(VICON), ["0.01", "0.02", "0.03", "0.04"]);
    assert_eq!(times_s(QUALISYS), ["0", "0.01"]);
    assert_eq!(times_s(&QUALISYS.replace("Frame\tTime\t", "Frame\tFlag\t")), ["0.01", "0.02"]);
}

#[test]
fn euler_angles_and_other_units_are_read() {
    let text = MOTIVE
        .replace("Rotation Type,Quaternion", "Rotation Type,XYZ")
        .replace("Length Units,Meters", "Length Units,Centimeters")
        .replace("0.000000,0.258819,0.000000,0.965926,0.100000,0.500000,-0.300000", "0,30,0,,10,50,-30");
    let tip = frames(&text, &BodySelection::default()).expect("it is read")[0].ends[0].expect("the tip is seen");
    assert!((tip.y_m - 0.3).abs() < 1e-9 && (tip.heading_rad.to_degrees() + 30.0).abs() < 1e-9, "{tip:?}");
}

#[test]
fn bodies_are_selected_by_name_in_the_given_order() {
    let turned = frames(VICON, &names(&["tip", "Arm:Base"])).expect("it is read");
    let base = turned[0].base.expect("the first of them is the base");
    assert!((base.y_m - 0.3).abs() < 1e-9, "{base:?}");
    let alone = frames(VICON, &names(&["tip"])).expect("it is read");
    assert!(alone[0].base.is_none() && alone[0].ends[0].is_some());
}

#[test]
fn the_axis_to_the_viewer_can_be_another_than_the_vertical_one() {
    let selection = BodySelection { up: Some(Axis::Z), ..BodySelection::default() };
    let tip = frames(MOTIVE, &selection).expect("it is read")[0].ends[0].expect("the tip is seen");
    assert!((tip.y_m - 0.5).abs() < 1e-9, "{tip:?}");
}

#[test]
fn other_bodies_than_those_of_the_arm_are_refused_by_name() {
    let found = || vec!["Base".to_owned(), "Tip".to_owned()];
    let unknown = refused(MOTIVE, &names(&["Top"]));
    assert_eq!(unknown, MotionCaptureProblem::Unknown { name: "Top".to_owned(), found: found() });
    assert_eq!(refused(MOTIVE, &names(&["Tip", "Tip"])), MotionCaptureProblem::Twice("Tip".to_owned()));
    let three = VICON.replace("Tip,,,,,", "Tip,,,,,,Other,,,,,");
    let three = three
        .replace("RZ,TX,TY,TZ\n", "RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\n")
        .replace("mm,mm,mm\n", "mm,mm,mm,deg,deg,deg,mm,mm,mm\n");
    assert!(
        matches!(refused(&three, &BodySelection::default()), MotionCaptureProblem::Count { found, .. } if found.len() == 3)
    );
}

#[test]
fn an_export_without_bodies_or_with_an_unknown_unit_is_refused() {
    let markers = "Trajectories\n100\n,,A,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n1,0,1,2,3\n";
    assert_eq!(refused(markers, &BodySelection::default()), MotionCaptureProblem::NoBodies);
    let markers = QUALISYS.replace("BODY_NAMES\tBase\tTip", "MARKER_NAMES\tA\tB");
    assert_eq!(refused(&markers, &BodySelection::default()), MotionCaptureProblem::NoBodies);
    let inches = MOTIVE.replace("Length Units,Meters", "Length Units,Inches");
    assert_eq!(refused(&inches, &BodySelection::default()), MotionCaptureProblem::Unit("Inches".to_owned()));
    let cut = QUALISYS.split("Frame\t").next().expect("the begin");
    assert_eq!(refused(cut, &BodySelection::default()), MotionCaptureProblem::Header);
    let markers = "time_s,truth1_x_mm,truth1_y_mm,truth1_heading_deg\n0,1,2,3\n";
    assert_eq!(refused(markers, &names(&["Base"])), MotionCaptureProblem::NotAnExport);
}

#[test]
fn an_error_of_a_cell_names_line_and_column() {
    let error = frames(&QUALISYS.replace("2\t0.01000\t100.0", "2\t0.01000\t1oo.0"), &BodySelection::default());
    let error = error.expect_err("it is no number").to_string();
    assert!(error.contains("line 11, column 3: \"1oo.0\" is not a number"), "{error}");
}
