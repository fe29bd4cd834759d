//! `proprio report`.

use std::io::Write;
use std::path::{Path, PathBuf};

use estimator_core::saturations;
use proprio::error::Error;
use proprio::output::OutputFile;
use proprio::replay::NamedTable;
use proprio::report::Gathering;
use proprio::session::LAST_LINE;

use crate::cli::Report;

pub fn run(args: &Report) -> Result<(), Error> {
    let table = NamedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let outputs = [Some(&args.output), args.json.as_ref(), args.csv.as_ref()].into_iter().flatten();
    let outputs: Vec<PathBuf> =
        outputs.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone())).collect();
    if let Some(twice) = (1..outputs.len()).find(|i| outputs[..*i].contains(&outputs[*i])) {
        return Err(Error::OutputTwice(outputs[twice].clone()));
    }
    let create = |path: &PathBuf| OutputFile::create(path, &inputs);
    let page = create(&args.output)?;
    let json = args.json.as_ref().map(create).transpose()?;
    let csv = args.csv.as_ref().map(create).transpose()?;

    let mut gathering = Gathering::new(&table);
    for path in &args.sessions {
        if !gathering.add(path)?.ends_with_line {
            super::warn(&format_args!("{}: {LAST_LINE}", path.display()));
        }
    }
    match saturations() {
        0 => {}
        times => super::warn(&format_args!(
            "fixed point saturated {times} times: a reading or the table is out of range; compare with replay --float"
        )),
    }
    let report = gathering.finish()?;
    let mut files = vec![written(page, &report.html())?];
    if let Some(json) = json {
        files.push(written(json, &report.json())?);
    }
    if let Some(csv) = csv {
        files.push(written(csv, &report.csv())?);
    }
    // The files get their names last, so that a command that fails leaves none.
    files.into_iter().try_for_each(OutputFile::finish)
}

fn written(mut file: OutputFile, text: &str) -> Result<OutputFile, Error> {
    file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(|error| file.error(error))?;
    Ok(file)
}
