//! Files of the workspace, and the comments, messages and prose in them.

use std::fs;
use std::path::{Path, PathBuf};

/// A Rust file.
pub struct Source {
    /// Relative to the workspace.
    pub path: String,
    /// Folder of its crate.
    pub package: String,
    pub text: String,
}

/// Kind of a text for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextKind {
    Comment,
    Message,
    Document,
}

/// A line of text for people.
pub struct Text {
    pub kind: TextKind,
    /// File and line.
    pub path: String,
    pub line: usize,
    pub words: String,
}

/// The workspace's folder.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files below a folder in the order of their names, without build products and hidden folders.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("the folder can be read").path())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            if name != "target" && !name.starts_with('.') {
                files(&path, found);
            }
        } else {
            found.push(path);
        }
    }
}

fn with_extension(extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(&workspace(), &mut found);
    found.retain(|path| path.extension().is_some_and(|found| found == extension));
    found
}

fn relative(path: &Path) -> String {
    path.strip_prefix(workspace()).expect("the file is in the workspace").to_string_lossy().replace('\\', "/")
}

/// The nearest folder with a manifest.
fn package(path: &Path) -> String {
    let folder = path.ancestors().skip(1).find(|folder| folder.join("Cargo.toml").exists());
    relative(folder.expect("each file is in the workspace"))
}

/// All Rust files.
pub fn rust_files() -> Vec<Source> {
    let read = |path: PathBuf| Source {
        path: relative(&path),
        package: package(&path),
        text: fs::read_to_string(&path).expect("a source file is UTF-8"),
    };
    with_extension("rs").into_iter().map(read).collect()
}

/// Root files of all crates: libraries and programs, without tests and examples.
pub fn crate_roots() -> Vec<PathBuf> {
    let is_root = |path: &PathBuf| {
        let path = relative(path);
        path.ends_with("src/lib.rs")
            || path.ends_with("src/main.rs")
            || path.contains("src/bin/") && path.ends_with("main.rs")
    };
    with_extension("rs").into_iter().filter(is_root).collect()
}

/// All text for people: comments and messages of Rust and JavaScript, documents.
pub fn texts() -> Vec<Text> {
    let mut texts = Vec::new();
    for path in with_extension("rs").into_iter().chain(with_extension("js")) {
        let source = fs::read_to_string(&path).expect("a source file is UTF-8");
        lex(&relative(&path), &source, &mut texts);
    }
    for path in with_extension("md") {
        let name = relative(&path);
        for (line, text) in (1..).zip(fs::read_to_string(&path).expect("a document is UTF-8").lines()) {
            texts.push(Text { kind: TextKind::Document, path: name.clone(), line, words: text.to_owned() });
        }
    }
    texts
}

/// Comments line by line, and strings that hold more than a word.
fn lex(path: &str, source: &str, texts: &mut Vec<Text>) {
    let mut rest = source;
    let mut line = 1;
    while let Some(first) = rest.chars().next() {
        let (kind, length) = token(rest);
        let (token, after) = rest.split_at(length.max(first.len_utf8()));
        if let Some(kind) = kind {
            for (offset, text) in token.lines().enumerate() {
                let text = text.trim().trim_start_matches(['/', '*', '!']).trim();
                if kind == TextKind::Comment && !text.is_empty() || token.contains(' ') {
                    texts.push(Text { kind, path: path.to_owned(), line: line + offset, words: text.to_owned() });
                }
            }
        }
        line += token.matches('\n').count();
        rest = after;
    }
}

/// Kind and length of the token at the start of a source.
fn token(source: &str) -> (Option<TextKind>, usize) {
    let until = |end: &str, from: usize| source[from..].find(end).map_or(source.len(), |at| from + at + end.len());
    if source.starts_with("//") {
        return (Some(TextKind::Comment), source.find('\n').unwrap_or(source.len()));
    }
    if source.starts_with("/*") {
        return (Some(TextKind::Comment), until("*/", 2));
    }
    if let Some(raw) = source.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        if raw[hashes..].starts_with('"') {
            return (Some(TextKind::Message), until(&format!("\"{}", "#".repeat(hashes)), hashes + 2));
        }
    }
    if source.starts_with('"') {
        return (Some(TextKind::Message), string_length(source));
    }
    // Of characters only those that would begin something else matter.
    if source.starts_with("'\"'") || source.starts_with("'/'") {
        return (None, 3);
    }
    if source.starts_with("'\\") {
        return (None, until("'", 3));
    }
    // A whole word, so that the r in its end begins no raw string.
    let word = source.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(source.len());
    (None, word)
}

/// Length of the string at the start of a source, with its quotes.
fn string_length(source: &str) -> usize {
    let mut is_escaped = false;
    for (at, character) in source.char_indices().skip(1) {
        match character {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    source.len()
}

/// Returns whether a file below `src` is compiled for tests alone, by its name.
pub fn is_test(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or(path);
    name == "tests.rs" || name == "test_support.rs" || name.ends_with("_tests.rs") || path.contains("/tests/")
}
