//! The rehearsal of `docs/tutorials/first-run.md`, as a reader types it, and its output in the guide.

use std::fs;
use std::path::Path;

use super::common::{Folder, arm};

/// The fenced blocks of a language in one section.
fn blocks<'g>(section: &'g str, language: &str) -> Vec<&'g str> {
    let begin = format!("```{language}\n");
    let blocks = section.split(begin.as_str()).skip(1);
    blocks.map(|block| block.split("```").next().expect("a block ends")).collect()
}

#[test]
fn the_rehearsal_runs_and_prints_the_output_in_the_guide() {
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/tutorials/first-run.md");
    let guide = fs::read_to_string(guide).expect("the guide is committed");
    let (_, section) = guide.split_once("\n## Rehearsal\n").expect("the guide has a rehearsal");

    let folder = Folder::new();
    fs::copy(arm(), folder.path("arm.toml")).expect("the guide copies it too");
    let mut printed = String::new();
    let mut commands = Vec::new();
    for line in blocks(section, "sh").into_iter().flat_map(str::lines) {
        let Some(args) = line.strip_prefix("proprio ") else { continue };
        let args: Vec<&str> = args.split_whitespace().collect();
        printed.push_str(&folder.done(&args).stdout);
        commands.push(args[0].to_owned());
    }
    for command in ["simulate", "align", "calibrate", "tune", "replay", "report"] {
        assert!(commands.iter().any(|run| run == command), "{command} is part of the way: {commands:?}");
    }
    let expected: Vec<&str> = blocks(section, "text").into_iter().flat_map(str::lines).collect();
    assert!(expected.len() >= 10, "{expected:?}");
    for line in expected {
        assert!(printed.lines().any(|found| found == line), "{line:?} is not in\n{printed}");
    }
}
