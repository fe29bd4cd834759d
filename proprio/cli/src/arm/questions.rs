//! Options that are asked for on a terminal.

use std::io::{BufRead, IsTerminal};
use std::str::FromStr;

use super::error::NewArmError;
use crate::terminal;

/// An option and the question in its place.
pub struct Question {
    /// The option.
    pub option: &'static str,
    /// The question.
    pub text: &'static str,
}

/// The numbers of an option, or of the answer to its question where standard input is a terminal.
pub fn answer<T: FromStr + Clone>(given: Option<&[T]>, question: &Question) -> Result<Vec<T>, NewArmError> {
    match given {
        Some(numbers) => Ok(numbers.to_vec()),
        None if std::io::stdin().is_terminal() => {
            terminal::eprint_line(&question.text);
            read(question.option, &mut std::io::stdin().lock())
        }
        None => Err(NewArmError::Missing(question.option)),
    }
}

/// The number of an option, or of the answer to its question where standard input is a terminal; else, and for an empty
/// answer, `default`.
pub fn answer_or<T: FromStr + Copy>(given: Option<T>, question: &Question, default: T) -> Result<T, NewArmError> {
    match given {
        Some(number) => Ok(number),
        None if std::io::stdin().is_terminal() => {
            terminal::eprint_line(&question.text);
            read_one(question.option, default, &mut std::io::stdin().lock())
        }
        None => Ok(default),
    }
}

/// Reads a line with one number or none.
fn read_one<T: FromStr + Copy>(option: &'static str, default: T, input: &mut dyn BufRead) -> Result<T, NewArmError> {
    let line = read_line(option, input)?;
    let number = || line.parse().map_err(|_| NewArmError::Number { option, part: line.clone() });
    if line.is_empty() { Ok(default) } else { number() }
}

/// Reads a line without the space around it.
fn read_line(option: &'static str, input: &mut dyn BufRead) -> Result<String, NewArmError> {
    let mut line = String::new();
    input.read_line(&mut line).map_err(|source| NewArmError::Answer { option, source })?;
    Ok(line.trim().to_owned())
}

/// Reads a line of numbers with commas between them.
fn read<T: FromStr>(option: &'static str, input: &mut dyn BufRead) -> Result<Vec<T>, NewArmError> {
    let line = read_line(option, input)?;
    if line.is_empty() {
        return Err(NewArmError::Missing(option));
    }
    let number =
        |part: &str| part.trim().parse().map_err(|_| NewArmError::Number { option, part: part.trim().to_owned() });
    line.split(',').map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(line: &str) -> Result<Vec<f64>, String> {
        read("--lengths-mm", &mut line.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn an_answer_is_a_list_with_commas_and_spaces() {
        assert_eq!(lengths("90, 80.5,70\n"), Ok(vec![90.0, 80.5, 70.0]));
    }

    #[test]
    fn no_answer_is_a_missing_option() {
        for line in ["", "\n", "  \n"] {
            assert_eq!(lengths(line), Err("--lengths-mm is missing".to_owned()));
        }
    }

    #[test]
    fn an_option_with_a_default_has_one_number_or_none() {
        let regulators =
            |line: &str| read_one("--regulators", 0_u8, &mut line.as_bytes()).map_err(|error| error.to_string());
        assert_eq!(regulators(" 4 \n"), Ok(4));
        assert_eq!(regulators("\n"), Ok(0));
        let error = "--regulators: \"4,4\" is not a number that it takes";
        assert_eq!(regulators("4,4\n"), Err(error.to_owned()));
    }

    #[test]
    fn a_part_that_is_no_number_is_named() {
        assert_eq!(lengths("90,long\n"), Err("--lengths-mm: \"long\" is not a number that it takes".to_owned()));
    }
}
