//! Sessions that the page opens.

use std::path::{Path, PathBuf};

use proprio_monitor::{Monitor, Options};
use proprio_session::recording::Recorder;
use proprio_session::{HostNs, LoadedTable};
use telemetry::{Encoder, MAX_FRAME, Message};

use super::http::Page;
use super::line::sample;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn table() -> PathBuf {
    Path::new(ROOT).join("calibration-tables/planar-6.toml")
}

pub fn session(name: &str) -> PathBuf {
    Path::new(ROOT).join("host-tests/sessions").join(name)
}

/// A monitor without a board, whose folder has a session in it.
pub fn page(given: Option<PathBuf>) -> Page {
    let folder = tempfile::tempdir().expect("there is room for a temporary folder");
    std::fs::copy(session("scenario-2.csv"), folder.path().join("a b.csv")).expect("there is room");
    let table = table();
    let options = Options {
        port: 0,
        table: Some(LoadedTable::load(&table).expect("the reference table")),
        folder: folder.path().to_owned(),
        token: None,
        session: given,
        runtime_folder: None,
        stream: None,
        help: ToString::to_string,
        finding_text: ToString::to_string,
    };
    let runtime_folder = tempfile::tempdir().expect("there is room for a temporary folder");
    Page { monitor: Monitor::start(None, options).expect("a free port"), folder, runtime_folder }
}

#[test]
fn a_session_of_the_folder_is_listed_and_opened_with_its_truth() {
    let page = page(None);
    assert!(page.get("/sessions").text().contains(r#""name":"a b.csv""#), "{}", page.get("/sessions").text());
    let opened = page.get("/session?name=a%20b.csv");
    let about = opened.about();
    assert_eq!((&about["rows"], &about["samples"], &about["every"]), (&600.into(), &600.into(), &1.into()));
    assert_eq!(about["arm"]["geometry"][0]["length_mm"], 80.0);

    // The last row of the estimates that the host tests expect, 59 s.
    let begin = opened.body.iter().position(|byte| *byte == b'\n').expect("a line") + 1;
    let shown = |name: &str| {
        let columns = about["arm"]["columns"].as_array().expect("names");
        let place = columns.iter().position(|column| column == name).expect("a column");
        let bytes = &opened.body[begin + 600 * 8 + (place * 600 + 590) * 4..][..4];
        f32::from_le_bytes(bytes.try_into().expect("four bytes"))
    };
    let cell = |path: PathBuf, name: &str| {
        let text = std::fs::read_to_string(path).expect("a committed file");
        let place = text.lines().next().and_then(|head| head.split(',').position(|column| column == name));
        let row = text.lines().find(|row| row.starts_with("59,") || row.starts_with("59.0,"));
        let cell = row.and_then(|row| row.split(',').nth(place.expect("a column")));
        cell.and_then(|cell| cell.parse::<f32>().ok()).expect("a number")
    };
    let truth = cell(session("scenario-2.csv"), "truth6_x_mm");
    assert!((shown("truth6_x_mm") - truth).abs() < 1e-3);
    let expected = cell(Path::new(ROOT).join("host-tests/expected/scenario-2.csv"), "fusion6_x_mm");
    assert!((shown("x6_mm") - expected).abs() < 1e-3, "{} and {expected}", shown("x6_mm"));
    assert!(shown("drift6_deg").abs() > 0.5 && shown("innovation_imu6_deg").is_finite());
}

#[test]
fn a_session_is_replayed_with_a_table_of_the_folder_and_no_other_file_is_one() {
    let page = page(None);
    let text = std::fs::read_to_string(table()).expect("a committed file");
    let longer = text.replacen("length_mm = 80.0", "length_mm = 90.0", 1);
    std::fs::write(page.folder.path().join("longer.toml"), longer).expect("there is room");
    assert!(page.get("/sessions").text().contains(r#""name":"longer.toml""#), "{}", page.get("/sessions").text());
    let about = page.get("/session?name=a%20b.csv&table=longer.toml").about();
    assert_eq!((&about["arm"]["geometry"][0]["length_mm"], &about["rows"]), (&90.0.into(), &600.into()));
    for name in ["a%20b.csv", "missing.toml", "..%2Flonger.toml"] {
        let answer = page.get(&format!("/session?name=a%20b.csv&table={name}"));
        assert_eq!(answer.status, 409, "{name}");
        assert!(answer.text().contains("there is no such table in the folder"), "{}", answer.text());
    }
}

#[test]
fn a_part_of_a_session_is_what_is_between_two_times() {
    let page = page(None);
    let about = page.get("/session?name=a%20b.csv&from_s=10&to_s=19.95").about();
    assert_eq!((&about["rows"], &about["samples"]), (&100.into(), &100.into()));
}

/// A mark has the host's time, and may be written behind samples that came after it.
#[test]
fn the_marks_of_a_recording_have_the_time_of_its_rows() {
    let page = page(None);
    let at_ms = |ms: u64| HostNs(1_764_000_000_000_000_000 + ms * 1_000_000);
    let mut recorder = Recorder::new(Vec::new(), at_ms(0), "a test").expect("memory takes all");
    let (mut encoder, mut buffer) = (Encoder::new(), [0; MAX_FRAME]);
    for tick in 0..600 {
        let message = Message::Sample(sample(tick));
        let frame = encoder.encode(&message, &mut buffer).expect("it fits");
        recorder.bytes(at_ms(10 * u64::from(tick)), frame).expect("memory takes all");
        recorder.message(at_ms(10 * u64::from(tick)), &message).expect("memory takes all");
        match tick {
            150 => recorder.mark(at_ms(1503), "push").expect("memory takes all"),
            404 => recorder.mark(at_ms(4000), "let go").expect("memory takes all"),
            _ => {}
        }
    }
    let recording = recorder.finish().expect("memory takes all");
    std::fs::write(page.folder.path().join("marked.mcap"), recording).expect("there is room");

    let expected = [("push", 1.503), ("let go", 4.0)];
    let expected = expected.map(|(text, time_s)| serde_json::json!({ "text": text, "time_s": time_s }));
    assert_eq!(page.get("/session?name=marked.mcap").about()["marks"], serde_json::json!(expected));
    let part = page.get("/session?name=marked.mcap&from_s=2&to_s=5").about();
    assert_eq!(part["marks"], serde_json::json!(expected[1..]));
    assert_eq!(page.get("/session?name=a%20b.csv").about()["marks"], serde_json::json!([]));
}

#[test]
fn a_file_elsewhere_or_of_another_kind_is_not_opened() {
    let page = page(None);
    std::fs::write(page.folder.path().join("secret.txt"), "secret").expect("there is room");
    let outside = session("scenario-1.csv").display().to_string();
    for name in ["secret.txt", "..%2Fa%20b.csv", "missing.csv", "", &outside.replace('/', "%2F")] {
        let answer = page.get(&format!("/session?name={name}"));
        assert_eq!(answer.status, 404, "{name}: {}", answer.text());
    }
}

#[test]
fn a_session_that_the_browser_sends_is_opened_and_a_bad_one_named() {
    let page = page(None);
    let text = std::fs::read_to_string(session("scenario-1.csv")).expect("a committed file");
    assert_eq!(page.post("/sessions?name=mine.csv", &text).status, 200);
    assert_eq!(page.get("/session?name=mine.csv").about()["rows"], 600);

    assert_eq!(page.post("/sessions?name=bad.csv", "time_s,bend1a_adc\n0,x\n").status, 200);
    let answer = page.get("/session?name=bad.csv");
    assert_eq!(answer.status, 409);
    assert!(answer.text().starts_with("bad.csv, line 1: column bend1b_adc is missing"), "{}", answer.text());
}

#[test]
fn the_session_that_the_command_was_given_is_opened_wherever_it_is() {
    let page = page(Some(session("scenario-3.csv")));
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    let arm = socket.next("arm");
    assert_eq!((&arm["session"], &arm["is_live"]), (&"scenario-3.csv".into(), &false.into()));
    assert_eq!(page.get("/session?name=scenario-3.csv").about()["rows"], 600);
}

#[test]
fn a_long_session_is_thinned_to_what_a_page_holds() {
    let page = page(None);
    let text = std::fs::read_to_string(session("scenario-1.csv")).expect("a committed file");
    let (head, rows) = text.split_once('\n').expect("a header");
    let cells = rows.lines().next().and_then(|row| row.split_once(',')).expect("cells").1;
    let long: Vec<String> = (0..130_000).map(|i| format!("{}.{:02},{cells}\n", i / 100, i % 100)).collect();
    let long = long.concat();
    std::fs::write(page.folder.path().join("long.csv"), format!("{head}\n{long}")).expect("there is room");
    let about = page.get("/session?name=long.csv").about();
    assert_eq!((&about["samples"], &about["every"], &about["rows"]), (&130_000.into(), &4.into(), &32_500.into()));
}
