//! `proprio report`.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use estimator_core::saturations;
use proprio_analysis::replay::NotComparable;
use proprio_analysis::report::ReportBuilder;
use proprio_session::{Existing, LoadedTable, OutputFile};

use super::warnings::warn_of_defects;
use crate::args::ReportArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &ReportArgs) -> Result<(), Error> {
    let table = LoadedTable::load(&args.table)?;
    let other = args.compare.as_deref().map(LoadedTable::load).transpose()?;
    let tables = [&args.table].into_iter().chain(&args.compare);
    let inputs: Vec<&Path> = args.sessions.iter().chain(tables).map(PathBuf::as_path).collect();
    let outputs = [Some(&args.output), args.json.as_ref(), args.csv.as_ref()].into_iter().flatten();
    let outputs: Vec<PathBuf> =
        outputs.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone())).collect();
    if let Some(twice) = (1..outputs.len()).find(|i| outputs[..*i].contains(&outputs[*i])) {
        return Err(Error::OutputTwice(outputs[twice].clone()));
    }
    let create = |path: &PathBuf| OutputFile::create(path, &inputs, args.force.existing());
    let page = create(&args.output)?;
    let json = args.json.as_ref().map(create).transpose()?;
    let csv = args.csv.as_ref().map(create).transpose()?;
    if let Some(folder) = &args.figures {
        check_folder(folder, args.force.existing())?;
    }

    let mut progress = Bar::new();
    let mut builder = ReportBuilder::new(&table).command(command_line());
    if let Some(other) = &other {
        builder = builder.compare_with(other)?;
    }
    for path in &args.sessions {
        let summary = builder.add(path, &mut progress)?;
        if summary.not_comparable > 0 {
            terminal::warn(&format_args!("{}: {}", path.display(), NotComparable(&summary)));
        }
        warn_of_defects(path, &summary.defects);
    }
    drop(progress);
    match saturations() {
        0 => {}
        times => terminal::warn(&format_args!(
            "fixed point saturated {times} times: a reading or the table is out of range; compare with replay --float"
        )),
    }
    let report = builder.finish()?;
    let mut files = vec![written(page, &report.html())?];
    if let Some(json) = json {
        files.push(written(json, &report.json())?);
    }
    if let Some(csv) = csv {
        files.push(written(csv, &report.csv())?);
    }
    if let Some(folder) = &args.figures {
        fs::create_dir_all(folder).map_err(|source| proprio_session::Error::Output { path: folder.clone(), source })?;
        for figure in report.paper_figures() {
            files.push(written(create(&folder.join(figure.name))?, &figure.svg)?);
        }
    }
    // The files get their names last, so that a command that fails leaves none.
    for file in files {
        terminal::eprint_line(&file.finish()?);
    }
    Ok(())
}

/// The command as it was typed, with the arguments in quotes that a shell would divide.
fn command_line() -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./:=,+@%".contains(letter);
    let quoted = |argument: std::borrow::Cow<str>| match argument {
        plain if !plain.is_empty() && plain.chars().all(is_plain) => plain.into_owned(),
        other => format!("'{}'", other.replace('\'', "'\\''")),
    };
    let arguments = std::env::args_os().skip(1).map(|argument| quoted(argument.to_string_lossy()));
    ["proprio".to_owned()].into_iter().chain(arguments).collect::<Vec<_>>().join(" ")
}

/// Refuses a folder that has files already, unless they may be replaced.
pub(super) fn check_folder(folder: &Path, existing: Existing) -> Result<(), Error> {
    let is_filled = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    if is_filled && existing == Existing::Keep {
        return Err(proprio_session::Error::Exists(folder.to_owned()).into());
    }
    Ok(())
}

fn written(mut file: OutputFile, text: &str) -> Result<OutputFile, Error> {
    file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(|error| file.error(error))?;
    Ok(file)
}
