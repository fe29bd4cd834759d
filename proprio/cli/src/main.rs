//! The program `proprio`.

use std::process::ExitCode;

fn main() -> ExitCode {
    proprio::run()
}
