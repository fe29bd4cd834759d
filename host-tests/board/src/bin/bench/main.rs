//! `cargo xtask bench`: what the firmware costs, against its budgets.

mod budgets;
mod firmware;
mod jitter;
mod step;
mod tasks;
mod trouble;

use std::process::ExitCode;

/// Something that was measured.
pub struct Figure {
    /// Its name in the budgets' file.
    pub name: &'static str,
    /// In the unit that the file states.
    pub value: f64,
}

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
