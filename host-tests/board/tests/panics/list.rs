//! The list of the paths to a panic that cannot be reached, `host-tests/board/panics.toml`.

use std::collections::BTreeSet;

use toml_edit::{DocumentMut, Item, Table};

use crate::paths::Path;

/// Caller in the list that stands for every caller.
const ANY: &str = "*";

/// A path of the list, and the reason why it is not reached.
#[derive(Debug)]
pub struct Listed {
    pub path: Path,
    pub reason: String,
}

/// Reads the list.
///
/// # Panics
/// If it is not TOML, or an entry lacks one of its keys.
pub fn read(toml: &str) -> Vec<Listed> {
    let document: DocumentMut = toml.parse().expect("the list is TOML");
    let entries = document.get("path").and_then(|paths| paths.as_array_of_tables()).into_iter().flatten();
    entries.map(listed).collect()
}

fn listed(entry: &Table) -> Listed {
    let required = |key: &str| {
        let text = entry.get(key).and_then(Item::as_str);
        text.unwrap_or_else(|| panic!("`{key}` is missing in the list at\n{entry}")).to_owned()
    };
    let path = Path { caller: required("caller"), entry: required("entry") };
    Listed { path, reason: required("reason") }
}

/// Differences between the paths of a program and a list: paths that are not listed, entries without a path, and entries
/// without a reason.
pub fn differences(found: &BTreeSet<Path>, list: &[Listed]) -> Vec<String> {
    let new = found.iter().filter(|path| !list.iter().any(|listed| covers(&listed.path, path)));
    let gone = list.iter().filter(|listed| !found.iter().any(|path| covers(&listed.path, path)));
    let unexplained = list.iter().filter(|listed| listed.reason.trim().is_empty());
    new.map(|path| format!("not on the list:\n{}", entry(path)))
        .chain(gone.map(|listed| format!("on the list, and no longer in the program:\n{}", entry(&listed.path))))
        .chain(unexplained.map(|listed| format!("on the list without a reason:\n{}", entry(&listed.path))))
        .collect()
}

fn covers(listed: &Path, path: &Path) -> bool {
    (listed.caller == ANY || listed.caller == path.caller) && listed.entry == path.entry
}

/// A path as it is written in the list.
pub fn entry(Path { caller, entry }: &Path) -> String {
    format!("[[path]]\ncaller = {caller:?}\nentry = {entry:?}\n")
}
