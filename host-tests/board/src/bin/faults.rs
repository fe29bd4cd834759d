//! Measures every fault on the emulated board, or those named, and prints them or writes a page.
//!
//! `faults`: all, in `docs/reference/faults-measured.md`; `faults NAME …`: these, on the standard output.

use std::env;
use std::fmt::Write;
use std::path::Path;

use board_tests::fault_rows::{Measured, measure, rows};

const HEAD: &str = "# Faults, measured

What the firmware does when faults are [injected by name](faults.md) into the emulated board. `cargo
xtask faults` measures them and writes this page; the board tests check those that hold. The arm
swings freely for 15 s before each fault. Times count from the fault; the tip's distances are those of
the board's estimates from the simulated arm.

| fault | injected | promise | measured | holds |
|---|---|---|---|---|
";

fn main() {
    let names: Vec<String> = env::args().skip(1).collect();
    if !names.is_empty() {
        for name in &names {
            println!("{name}: {}", line(&measure(name)));
        }
        return;
    }
    let mut page = HEAD.to_owned();
    for (name, row) in rows() {
        eprintln!("{name}");
        writeln!(page, "{}", line(&row())).expect("text can be written");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/faults-measured.md");
    std::fs::write(path, page).expect("the page can be written");
}

fn line(row: &Measured) -> String {
    let holds = if row.holds { "yes" } else { "**no**" };
    format!("| {} | `{}` | {} | {} | {holds} |", row.row, row.injected, row.promise, row.measured)
}
