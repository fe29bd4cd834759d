//! The examples of docs/how-to/wiring.md: their sections `[board]` are valid, and the drawings show the same.

use std::fs;
use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, BoardToml};

fn how_to() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/how-to")
}

fn read(name: &str) -> String {
    fs::read_to_string(how_to().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The sections `[board]` of the page, each with the drawing above it.
fn examples() -> Vec<(String, BoardToml)> {
    let page = read("wiring.md");
    let blocks = page.match_indices("```toml\n").map(|(start, fence)| {
        let (before, after) = (&page[..start], &page[start + fence.len()..]);
        let drawing =
            before.rsplit_once("](").and_then(|(_, rest)| rest.split_once(".svg)")).expect("a drawing above").0;
        let section = after.split_once("```").expect("the end of the block").0;
        (format!("{drawing}.svg"), board(section))
    });
    blocks.collect()
}

/// The section, read in the description of an arm of as many segments.
fn board(section: &str) -> BoardToml {
    let segment = "[[segment]]\nlength_mm = 90\noffset_mm = 0\noffset_at = \"end\"\n";
    let segments = segment.repeat(section.matches("[[board.segment]]").count());
    let text = format!("format = 1\narm = \"example\"\nrate_hz = 100\n{segments}{section}");
    let file = ArmFile::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    file.board.expect("the block is a section [board]")
}

/// Labels of a drawing that name a pin or a place, sorted.
fn labels(drawing: &str) -> Vec<String> {
    let texts = drawing.split("</text>").filter_map(|text| text.rsplit_once('>')).map(|(_, text)| text);
    let is_place = |text: &&str| {
        let text = text.trim_start_matches("IMU: ");
        let digit = |letters: &str| {
            text.strip_prefix(letters).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
        };
        (text.contains(": ") && (digit("A") || digit("D"))) || digit("SD")
    };
    let mut labels: Vec<String> =
        texts.filter(is_place).map(|text| text.trim_start_matches("IMU: ").to_owned()).collect();
    labels.sort();
    labels
}

/// Labels of the pins and places of a section, and of the multiplexer's pins, sorted.
fn expected(board: &BoardToml) -> Vec<String> {
    let mut labels: Vec<String> = ["D20: SDA", "D21: SCL", "D22: multiplexer RESET"].map(str::to_owned).to_vec();
    for (number, segment) in (1..).zip(&board.segments) {
        labels.extend(segment.bend.iter().zip(["a", "b"]).map(|(pin, letter)| format!("{pin}: {number}{letter}")));
        labels.extend(segment.imu.map(|imu| format!("SD{}, {:#04x}", imu.channel, imu.address)));
    }
    labels.extend((1..).zip(&board.regulators).map(|(number, of)| format!("{}: regulator {number}", of.pin)));
    labels.sort();
    labels
}

#[test]
fn both_examples_are_valid_wirings() {
    let examples = examples();
    let counts = |board: &BoardToml| {
        let bend = board.segments.iter().map(|segment| segment.bend.len()).collect::<Vec<_>>();
        (bend, board.regulators.len())
    };
    let found: Vec<_> = examples.iter().map(|(_, board)| counts(board)).collect();
    assert_eq!(found, [(vec![1; 3], 3), (vec![2, 2, 2, 2, 1, 1, 1, 1], 8)]);
}

#[test]
fn each_drawing_shows_the_wiring_of_its_example() {
    for (name, board) in examples() {
        assert_eq!(labels(&read(&name)), expected(&board), "{name}");
    }
}
