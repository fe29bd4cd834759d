//! `cargo xtask fuzz`: runs the fuzz targets of `fuzz/` under libFuzzer.
//!
//! What a run has found stays in `target/fuzz/corpus`, and the next one begins with it and the seeds in `fuzz/corpus`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::tool::{check, root, target};

const USAGE: &str = "usage: cargo xtask fuzz [TARGET] [--seconds S] [--minimise]";

/// Time of each target, s, where `--seconds` gives no other.
const DEFAULT_SECONDS: u32 = 60;

/// Longest time for an input, s.
const INPUT_SECONDS: u32 = 10;

/// Lines at the end of a failed run that are shown.
const SHOWN_LINES: usize = 40;

/// Arguments of the command.
#[derive(Debug, PartialEq, Eq)]
struct Arguments {
    /// `None`: all.
    target: Option<String>,
    seconds: u32,
    /// Reduces the corpus of earlier runs to the files that its coverage needs.
    minimise: bool,
}

/// Figures of a run.
#[derive(Debug, PartialEq, Eq)]
struct Figures {
    inputs: u64,
    inputs_per_second: u64,
    /// Edges of the program that were reached.
    coverage: u64,
}

/// Builds the targets, and runs one or all of them; it fails where one has a finding.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let Arguments { target, seconds, minimise } = Arguments::parse(arguments)?;
    let targets = targets(target.as_deref())?;
    // One build for all, so that each crate is compiled once.
    check(cargo("build").arg("--bins"))?;
    let mut findings = Vec::new();
    println!("{:<14} {:>12} {:>10} {:>9} {:>10}", "target", "inputs", "inputs/s", "coverage", "new files");
    for target in &targets {
        let corpus = Corpus::of(target)?;
        if minimise {
            corpus.minimise(target)?;
        }
        let before = corpus.files()?;
        let output = corpus.fuzz(target, seconds)?;
        let text = String::from_utf8_lossy(&output.stderr);
        let Some(figures) = Figures::of(&text).filter(|_| output.status.success()) else {
            let lines: Vec<&str> = text.lines().collect();
            println!("{target}: {}\n{}", output.status, lines[lines.len().saturating_sub(SHOWN_LINES)..].join("\n"));
            findings.push(target.as_str());
            continue;
        };
        let (inputs, rate, coverage) = (figures.inputs, figures.inputs_per_second, figures.coverage);
        let new = corpus.files()?.saturating_sub(before);
        println!("{target:<14} {inputs:>12} {rate:>10} {coverage:>9} {new:>10}");
    }
    if findings.is_empty() {
        return Ok(());
    }
    Err(format!(
        "findings of {}, in {}: copy each to fuzz/corpus/TARGET, and mend what `cargo test -p fuzz-targets` shows",
        findings.join(", "),
        folder().join("findings").display()
    ))
}

impl Arguments {
    fn parse(arguments: &[String]) -> Result<Self, String> {
        let mut parsed = Self { target: None, seconds: DEFAULT_SECONDS, minimise: false };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            match argument.as_str() {
                "--seconds" => {
                    let value = rest.next().map_or("", String::as_str);
                    let seconds = value.parse().ok().filter(|seconds| (1..=1_000_000).contains(seconds));
                    parsed.seconds =
                        seconds.ok_or_else(|| format!("--seconds {value}: give whole seconds, 1 to 1000000"))?;
                }
                "--minimise" => parsed.minimise = true,
                name if !name.starts_with('-') && parsed.target.is_none() => parsed.target = Some(name.to_owned()),
                _ => return Err(USAGE.to_owned()),
            }
        }
        Ok(parsed)
    }
}

impl Figures {
    /// The figures in the output of libFuzzer.
    fn of(text: &str) -> Option<Self> {
        let number = |text: &str| text.split_whitespace().next()?.parse().ok();
        let after = |mark: &str| text.rsplit_once(mark).and_then(|(_, rest)| number(rest));
        Some(Self {
            inputs: after("stat::number_of_executed_units:")?,
            inputs_per_second: after("stat::average_exec_per_sec:")?,
            coverage: after(" cov: ")?,
        })
    }
}

/// The folder of builds, corpora and findings.
fn folder() -> PathBuf {
    target().join("fuzz")
}

/// Names of the targets: the one that is asked for, or all.
fn targets(wanted: Option<&str>) -> Result<Vec<String>, String> {
    let folder = root().join("fuzz/fuzz_targets");
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let stem = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let mut targets: Vec<String> = entries.flatten().filter_map(|entry| stem(entry.path())).collect();
    targets.sort();
    match wanted {
        None => Ok(targets),
        Some(wanted) if targets.iter().any(|target| target == wanted) => Ok(vec![wanted.to_owned()]),
        Some(wanted) => Err(format!("{wanted}: there is no such target; there are {}", targets.join(", "))),
    }
}

/// A command of cargo in `fuzz`, whose configuration has the flags. Flags in variables would replace them.
fn cargo(command: &str) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root().join("fuzz")).env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    cargo.args([command, "--quiet", "--release", "--target-dir"]).arg(folder());
    cargo
}

/// The inputs of a target that earlier runs have found, and its seeds.
struct Corpus {
    found: PathBuf,
    seeds: PathBuf,
}

impl Corpus {
    fn of(target: &str) -> Result<Self, String> {
        let corpus =
            Self { found: folder().join("corpus").join(target), seeds: root().join("fuzz/corpus").join(target) };
        create(&corpus.found)?;
        create(&folder().join("findings"))?;
        Ok(corpus)
    }

    /// Number of the inputs that were found.
    fn files(&self) -> Result<usize, String> {
        let entries = fs::read_dir(&self.found);
        entries.map(Iterator::count).map_err(|error| format!("{}: {error}", self.found.display()))
    }

    /// Runs a target, and returns its output.
    fn fuzz(&self, target: &str, seconds: u32) -> Result<Output, String> {
        let findings = folder().join("findings").join(format!("{target}-"));
        let mut command = libfuzzer(target);
        command.args([format!("-max_total_time={seconds}"), format!("-timeout={INPUT_SECONDS}")]);
        command.arg("-print_final_stats=1").arg(format!("-artifact_prefix={}", findings.display()));
        output(command.arg(&self.found).arg(&self.seeds))
    }

    /// Keeps the fewest of the found inputs that have their coverage.
    fn minimise(&self, target: &str) -> Result<(), String> {
        let (few, before) = (self.found.with_extension("few"), self.files()?);
        create(&few)?;
        let merged = output(libfuzzer(target).arg("-merge=1").arg(&few).arg(&self.found))?;
        if !merged.status.success() {
            return Err(format!("{target}: {}\n{}", merged.status, String::from_utf8_lossy(&merged.stderr)));
        }
        let replaced = fs::remove_dir_all(&self.found).and_then(|()| fs::rename(&few, &self.found));
        replaced.map_err(|error| format!("{}: {error}", self.found.display()))?;
        println!("{target}: {} of {before} found inputs have all of their coverage", self.files()?);
        Ok(())
    }
}

/// The program of a target.
fn libfuzzer(target: &str) -> Command {
    let mut command = cargo("run");
    command.args(["--bin", target, "--"]);
    command
}

fn output(command: &mut Command) -> Result<Output, String> {
    command.output().map_err(|error| format!("{}: {error}", command.get_program().display()))
}

fn create(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::{Arguments, Figures, USAGE};

    fn parse(line: &str) -> Result<Arguments, String> {
        Arguments::parse(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn all_targets_run_for_a_minute_and_one_as_long_as_is_asked() {
        assert_eq!(parse(""), Ok(Arguments { target: None, seconds: 60, minimise: false }));
        let one = Arguments { target: Some("profile".to_owned()), seconds: 5, minimise: true };
        assert_eq!(parse("profile --seconds 5 --minimise"), Ok(one));
        assert_eq!(parse("--second 5"), Err(USAGE.to_owned()));
        assert!(parse("--seconds 0").is_err_and(|error| error.contains("--seconds 0")));
    }

    #[test]
    fn figures_are_those_of_the_last_lines() {
        let text = "#2\tINITED cov: 8 ft: 8 corp: 1/1b exec/s: 0 rss: 27Mb\n\
                    #15280\tDONE   cov: 4099 ft: 13760 corp: 843/9327Kb lim: 24215 exec/s: 250 rss: 46Mb\n\
                    Done 15280 runs in 61 second(s)\n\
                    stat::number_of_executed_units: 15280\n\
                    stat::average_exec_per_sec:     250\n";
        assert_eq!(Figures::of(text), Some(Figures { inputs: 15_280, inputs_per_second: 250, coverage: 4099 }));
        assert_eq!(Figures::of("ERROR: no interesting inputs were found"), None);
    }
}
