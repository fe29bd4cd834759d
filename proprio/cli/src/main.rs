//! The program `proprio`.

use std::process::ExitCode;

fn main() -> ExitCode {
    proprio::run(std::env::args_os()).into()
}
