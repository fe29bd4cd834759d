//! Runs the firmware on the emulated board under random faults: `soak SECONDS SEED`.

use std::env;
use std::process::ExitCode;

use board_tests::soak::soak;

/// Board time from one line of progress to the next, s.
const PROGRESS_S: f64 = 60.0;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1).map(|argument| argument.parse::<u64>());
    let (Some(Ok(seconds)), Some(Ok(seed))) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: soak SECONDS SEED");
        return ExitCode::from(2);
    };
    let mut shown_s = 0.0;
    let report = soak(seed, seconds, |time_s| {
        if time_s - shown_s >= PROGRESS_S {
            shown_s = time_s;
            eprintln!("{time_s:.0} s of {seconds}");
        }
    });
    println!("{report}");
    let Some(last) = report.unexplained().last() else { return ExitCode::SUCCESS };
    let seconds = last.finding.time_s.ceil();
    println!("to repeat them: cargo xtask soak --seed {seed} --seconds {seconds}");
    ExitCode::FAILURE
}
