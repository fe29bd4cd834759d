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

/// Reads a line of numbers with commas between them.
fn read<T: FromStr>(option: &'static str, input: &mut dyn BufRead) -> Result<Vec<T>, NewArmError> {
    let mut line = String::new();
    input.read_line(&mut line).map_err(|source| NewArmError::Answer { option, source })?;
    if line.trim().is_empty() {
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
    fn a_part_that_is_no_number_is_named() {
        assert_eq!(lengths("90,long\n"), Err("--lengths-mm: \"long\" is no number of the list".to_owned()));
    }
}
