//! `cargo xtask bench`: time, memory and instructions of the firmware, against their budgets.

mod budgets;
mod fault_run;
mod figure;
mod firmware;
mod jitter;
mod step;
mod tasks;

use figure::Figure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let jitter = Figure { name: "trigger_jitter", value: jitter::cycles() };
    let figures = step::figures().into_iter().chain(firmware::figures()).chain(tasks::figures()).chain([jitter]);
    let figures: Vec<Figure> = figures.collect();
    match budgets::check(&figures) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
