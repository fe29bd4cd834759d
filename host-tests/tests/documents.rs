//! The project's documents: their links resolve, the book lists every page, and named code exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders that hold no documents of the project.
const SKIPPED: [&str; 4] = ["target", "node_modules", ".git", "fuzz"];

/// Most lines of the README.
const README_LINES: usize = 90;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

/// Every Markdown file below a folder, sorted.
fn documents(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the folder can be listed") {
        let path = entry.expect("the folder can be listed").path();
        let name = path.file_name().expect("an entry has a name").to_string_lossy().into_owned();
        if path.is_dir() {
            if !SKIPPED.contains(&name.as_str()) {
                found.extend(documents(&path));
            }
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Lines outside fenced and indented code, with their numbers from 1.
fn prose(text: &str) -> Vec<(usize, &str)> {
    let mut is_fenced = false;
    let mut lines = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            is_fenced = !is_fenced;
        } else if !is_fenced && !line.starts_with("    ") {
            lines.push((number + 1, line));
        }
    }
    lines
}

/// A link `[text](target)`, and its line.
struct Link<'t> {
    line: usize,
    text: &'t str,
    target: &'t str,
}

fn links(text: &str) -> Vec<Link<'_>> {
    let mut links = Vec::new();
    for (line, content) in prose(text) {
        for (middle, _) in content.match_indices("](") {
            let start = content[..middle].rfind('[').map_or(0, |at| at + 1);
            let target = &content[middle + 2..];
            let target = &target[..target.find(')').unwrap_or(target.len())];
            links.push(Link { line, text: &content[start..middle], target });
        }
    }
    links
}

/// The anchor that code hosts and mdBook give a heading.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim();
    let kept = heading.chars().filter(|&c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

fn anchors(text: &str) -> BTreeSet<String> {
    prose(text).into_iter().filter(|(_, line)| line.starts_with('#')).map(|(_, line)| anchor(line)).collect()
}

fn is_identifier(name: &str) -> bool {
    name.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// Fault of a link: a missing file, a missing anchor, or a name that the linked source file does not contain.
fn fault(document: &Path, link: &Link<'_>) -> Option<String> {
    if link.target.contains("://") || link.target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = link.target.split_once('#').unwrap_or((link.target, ""));
    if file.starts_with('/') {
        return Some("the path is not relative".to_owned());
    }
    let folder = document.parent().expect("a document is in a folder");
    let path = if file.is_empty() { document.to_owned() } else { folder.join(file) };
    if !path.exists() {
        return Some("no such file".to_owned());
    }
    if !anchor.is_empty() && !anchors(&read(&path)).contains(anchor) {
        return Some("no such heading".to_owned());
    }
    let is_source = path.extension().is_some_and(|extension| extension == "rs");
    let name = link.text.strip_prefix('`').and_then(|text| text.strip_suffix('`'));
    let name = name.and_then(|name| name.rsplit("::").next()).filter(|name| is_source && is_identifier(name));
    name.filter(|name| !read(&path).contains(name)).map(|name| format!("the file does not contain {name}"))
}

#[test]
fn links_and_anchors_resolve() {
    let mut faults = Vec::new();
    for document in documents(&root()) {
        for link in links(&read(&document)) {
            if let Some(fault) = fault(&document, &link) {
                faults.push(format!("{}:{}: {}: {fault}", document.display(), link.line, link.target));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_book_lists_every_page_once() {
    let docs = root().join("docs");
    let summary = read(&docs.join("SUMMARY.md"));
    let mut listed: Vec<PathBuf> = links(&summary).iter().map(|link| docs.join(link.target)).collect();
    listed.sort();
    let pages: Vec<PathBuf> = documents(&docs).into_iter().filter(|page| !page.ends_with("SUMMARY.md")).collect();
    assert_eq!(listed, pages, "docs/SUMMARY.md, and the pages in docs");
}

#[test]
fn the_readme_is_short() {
    let lines = read(&root().join("README.md")).lines().count();
    assert!(lines <= README_LINES, "README.md has {lines} lines");
}

#[test]
fn anchors_are_those_of_code_hosts() {
    assert_eq!(anchor("## Recording (MCAP)"), "recording-mcap");
    assert_eq!(anchor("### `replay --json`"), "replay---json");
    assert_eq!(anchor("## Bend angle θ"), "bend-angle-θ");
}
