//! `proprio new-arm`.

use std::io::Write;
use std::path::Path;

use calibration_tables::ArmFile;
use proprio_link::table::wiring;
use proprio_session::{OutputFile, is_stdout};

use crate::args::NewArmArgs;
use crate::arm::{NewArm, Question, answer, answer_or, description, wiring_table};
use crate::error::Error;
use crate::terminal;

const LENGTHS: Question = Question {
    option: "--lengths-mm",
    text: "Lengths of the segments' curved parts from the base, mm, with commas between them, such as 90,90,80:",
};

const BEND: Question = Question {
    option: "--bend",
    text: "Bend sensors of each segment, 0 to 2, with commas between them, such as 2,2,1:",
};

const REGULATORS: Question =
    Question { option: "--regulators", text: "Number of pressure regulators, 0 to 8 [default: 0]:" };

const FULL_SCALE: Question = Question {
    option: "--full-scale-kpa",
    text: "Pressure of the regulators at full duty, kPa over the atmosphere [default: 280]:",
};

/// Full scale of a regulator, kPa, unless another is given.
const FULL_SCALE_KPA: f64 = 280.0;

pub fn run(args: &NewArmArgs) -> Result<(), Error> {
    let lengths_mm = answer(args.lengths_mm.as_deref(), &LENGTHS)?;
    let bend_sensors = answer(args.bend.as_deref(), &BEND)?;
    let name = args.name.clone().unwrap_or_else(|| name_of(&args.output));
    let regulators = answer_or(args.regulators, &REGULATORS, 0)?;
    let full_scale_kpa = match args.full_scale_kpa {
        None if regulators == 0 => FULL_SCALE_KPA,
        given => answer_or(given, &FULL_SCALE, FULL_SCALE_KPA)?,
    };
    let arm = NewArm { name, lengths_mm, bend_sensors, regulators, full_scale_kpa };
    arm.check()?;
    let text = description(&arm);
    let to_error = |source| proprio_session::Error::Table { path: args.output.clone(), source };
    let parsed = ArmFile::parse(&text).map_err(to_error)?;
    let wiring =
        wiring(&parsed).map_err(|source| Error::TableImage { name: args.output.display().to_string(), source })?;
    let mut file = OutputFile::create(&args.output, &[], args.force.existing())?;
    file.write_all(text.as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    terminal::print_beside(Some(&args.output), &wiring_table(&wiring))?;
    terminal::eprint_line(&file.finish()?);
    Ok(())
}

/// Name of an arm from that of its file.
fn name_of(output: &Path) -> String {
    let stem = output.file_stem().filter(|_| !is_stdout(output));
    stem.map_or_else(|| "arm".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
