//! The page `docs/reference/commands.md`, written from the program's own arguments.
//!
//! `cargo xtask commands` writes it; without that, the test compares.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

use clap::{Arg, Command, CommandFactory};

use crate::args::Cli;

const INTRODUCTION: &str = "\
# Commands

`cargo xtask commands` makes this page from the program's own arguments. `proprio help` and `proprio help COMMAND` print the
same in a terminal; `proprio completions SHELL` prints completions for it.
";

/// A text for a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', r"\|")
}

/// An argument as it is typed: `-o, --output <FILE>`.
fn typed(argument: &Arg) -> String {
    match argument.get_short() {
        Some(short) if !argument.is_positional() => format!("`-{short}, {argument}`"),
        _ => format!("`{argument}`"),
    }
}

/// Meaning, values and default of an argument.
fn meaning(argument: &Arg) -> String {
    let mut meaning = argument.get_help().map(ToString::to_string).unwrap_or_default();
    if argument.get_action().takes_values() {
        let values: Vec<String> = argument
            .get_possible_values()
            .iter()
            .filter(|value| !value.is_hide_set())
            .map(|value| match value.get_help() {
                Some(help) => format!("<br>`{}`: {help}", value.get_name()),
                None => format!("<br>`{}`", value.get_name()),
            })
            .collect();
        meaning.push_str(&values.concat());
        let defaults = argument.get_default_values().iter().map(|value| value.to_string_lossy());
        let defaults = defaults.collect::<Vec<_>>().join(" ");
        if !defaults.is_empty() {
            let _ = write!(meaning, " [default: `{defaults}`]");
        }
    }
    meaning
}

fn section(command: &mut Command) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").replace("\n       ", "\n");
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name());
    let mut section = format!("\n## {name}\n\n{about}.\n\n```text\n{usage}\n```\n");
    let arguments: Vec<&Arg> =
        command.get_arguments().filter(|argument| !matches!(argument.get_id().as_str(), "help" | "version")).collect();
    if !arguments.is_empty() {
        section.push_str("\n| argument | meaning |\n|---|---|\n");
    }
    for argument in arguments {
        let _ = writeln!(section, "| {} | {} |", cell(&typed(argument)), cell(&meaning(argument)));
    }
    for command in command.get_subcommands_mut().filter(|command| command.get_name() != "help") {
        section.push_str(&self::section(command));
    }
    section
}

fn page() -> String {
    let mut program = Cli::command();
    program.build();
    let exit_status = program.get_after_help().map(ToString::to_string).unwrap_or_default();
    let mut page = format!("{INTRODUCTION}\n| command | purpose |\n|---|---|\n");
    let names: Vec<String> = program.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    for name in names.iter().filter(|name| *name != "help") {
        let command = program.find_subcommand(name).expect("it is listed");
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(page, "| [`{name}`](#proprio-{name}) | {} |", cell(&about));
    }
    let _ = writeln!(page, "\n{exit_status}");
    for name in names.iter().filter(|name| *name != "help") {
        page.push_str(&section(program.find_subcommand_mut(name).expect("it is listed")));
    }
    page
}

#[test]
fn commands_page_is_that_of_the_arguments() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/commands.md");
    let page = page();
    if env::var_os("PROPRIO_ACCEPT").is_some() {
        fs::write(&path, &page).expect("the page can be written");
    }
    let committed = fs::read_to_string(&path).expect("the page is committed");
    assert!(committed == page, "docs/reference/commands.md is not that of the arguments; run `cargo xtask commands`");
}
