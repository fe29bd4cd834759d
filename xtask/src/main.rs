//! Developer commands that cargo alone cannot do; `.cargo/config.toml` names them.

mod accept;
mod bench;
mod board;
mod commands;
mod demo;
mod dist;
mod faults;
mod fuzz;
mod panics;
mod pictures;
mod results;
mod soak;
mod style;
mod tool;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let command = arguments.first().map(String::as_str);
    let done = match command {
        Some("demo") => demo::run(arguments.get(1..).unwrap_or_default()),
        Some("accept") => accept::run(),
        Some("verify") => board::verify(),
        Some("bench") => bench::run(),
        Some("panics") => panics::run(),
        Some("dist") => dist::run(),
        Some("results") => results::run(),
        Some("style") => style::run(),
        Some("faults") => faults::run(),
        Some("fuzz") => fuzz::run(arguments.get(1..).unwrap_or_default()),
        Some("soak") => soak::run(arguments.get(1..).unwrap_or_default()),
        Some("commands") => commands::run(),
        Some("pictures") => pictures::run(),
        _ => Err(
            "usage: cargo xtask demo | verify | bench | faults | soak | fuzz | panics | dist | style | results | commands | pictures | accept"
                .to_owned(),
        ),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
