//! Paths to a panic in the firmware: each must be on the list with the reason why it is not reached. `cargo xtask panics`
//! prints them.

mod branches;
mod list;
mod paths;

use std::collections::BTreeSet;

use board_tests::{elf, firmware};

use crate::list::{Listed, differences, entry, read};
use crate::paths::{Path, paths};

const LIST: &str = include_str!("../../panics.toml");

#[test]
fn every_path_to_a_panic_in_the_firmware_is_on_the_list() {
    let found = paths(firmware());
    for path in &found {
        println!("{}", entry(path));
    }
    let differences = differences(&found, &read(LIST));
    assert!(
        differences.is_empty(),
        "host-tests/board/panics.toml: {}\nremove the path from the code, or give the reason why it is not reached",
        differences.join("\n")
    );
}

#[test]
fn functions_that_can_panic_are_found_by_their_names_in_the_source() {
    let found = paths(&elf("on-target-tests", "panics"));
    let entries = |caller: &str| -> BTreeSet<&str> {
        let caller = format!("panics::{caller}");
        found.iter().filter(|path| path.caller == caller).map(|path| path.entry.as_str()).collect()
    };
    assert_eq!(entries("indexes"), ["core::panicking::panic_bounds_check"].into());
    assert_eq!(entries("divides"), ["core::panicking::panic_const::panic_const_div_by_zero"].into());
    assert_eq!(entries("unwraps_inlined"), ["core::option::unwrap_failed"].into());
    assert_eq!(entries("adds"), [].into(), "wrapping arithmetic cannot panic");
}

#[test]
fn a_path_that_is_not_listed_and_an_entry_without_its_path_are_differences() {
    let path = |caller: &str, entry: &str| Path { caller: caller.into(), entry: entry.into() };
    let listed = |path, reason: &str| Listed { path, reason: reason.into() };
    let found = [path("tick", "panic_fmt"), path("poll", "resumed"), path("run", "resumed")].into();
    let tick = || listed(path("tick", "panic_fmt"), "deliberate");
    let any = || listed(path("*", "resumed"), "no future is polled after its end");
    assert_eq!(differences(&found, &[tick(), any()]), [""; 0]);
    assert_eq!(differences(&found, &[any()]).len(), 1, "new");
    assert_eq!(differences(&found, &[tick(), any(), listed(path("init", "panic_fmt"), "gone")]).len(), 1, "gone");
    assert_eq!(differences(&found, &[listed(path("tick", "panic_fmt"), " "), any()]).len(), 1, "no reason");
}
