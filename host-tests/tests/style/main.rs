//! Words, sizes and structure of the workspace's own text and code. `cargo xtask style` shows what is counted.

mod circles;
mod imports;
mod modules;
mod source;
mod words;

use std::collections::BTreeMap;

use crate::source::Source;

/// Lines of the largest file, and of the largest crate without its tests, benches and examples.
const MAX_FILE_LINES: usize = 400;
const MAX_CRATE_LINES: usize = 8000;

/// The most idioms in a thousand words.
const MAX_IDIOMS: f64 = 1.5;

/// The most comment lines in a hundred that begin with a question word.
const MAX_OPENINGS: f64 = 2.0;

#[test]
fn idioms_are_rare_in_comments_messages_and_documents() {
    let count = words::idioms(&source::texts());
    for place in &count.places {
        println!("{place}");
    }
    let per_thousand = 1000.0 * count.places.len() as f64 / count.words as f64;
    println!("{} idioms in {} words: {per_thousand:.2} in 1000", count.places.len(), count.words);
    assert!(per_thousand <= MAX_IDIOMS, "{per_thousand:.2} idioms in 1000 words, at most {MAX_IDIOMS}");
}

#[test]
fn few_comment_lines_begin_with_a_question_word() {
    let count = words::openings(&source::texts());
    for place in &count.places {
        println!("{place}");
    }
    let per_hundred = 100.0 * count.places.len() as f64 / count.words as f64;
    println!("{} of {} comment lines: {per_hundred:.2} in 100", count.places.len(), count.words);
    assert!(
        per_hundred <= MAX_OPENINGS,
        "{per_hundred:.2} question words in 100 comment lines, at most {MAX_OPENINGS}"
    );
}

#[test]
fn no_crate_has_a_circle_of_files() {
    let mut found = Vec::new();
    for root in source::crate_roots() {
        let tree = modules::Tree::read(&root);
        found.extend(circles::circles(&imports::imports(&tree)));
    }
    for circle in &found {
        println!("{}", circle.join(" <-> "));
    }
    assert!(found.is_empty(), "{} circles of files", found.len());
}

#[test]
fn files_and_crates_are_of_a_size_to_be_read() {
    let mut crates: BTreeMap<&str, usize> = BTreeMap::new();
    let mut long = Vec::new();
    let sources = source::rust_files();
    for Source { path, package, text } in &sources {
        let lines = text.lines().count();
        if path.contains("/src/") && !source::is_test(path) {
            *crates.entry(package).or_default() += lines;
        }
        if lines > MAX_FILE_LINES {
            long.push(format!("{path}: {lines} lines"));
        }
    }
    for (package, lines) in &crates {
        println!("{package}: {lines} lines");
    }
    long.extend(crates.iter().filter(|(_, lines)| **lines > MAX_CRATE_LINES).map(|(name, _)| format!("{name}: crate")));
    assert!(long.is_empty(), "too long: {}", long.join(", "));
}
