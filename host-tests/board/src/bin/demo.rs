//! The firmware on the emulated board in scenario I: armed, moved, its estimate compared with the truth, its stream recorded.

use std::env;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

use board_tests::{Board, View, replay, table};
use proprio_simulation::{ImuColumns, Recorded, SessionWriter};
use rig_twin::{Layout, MotionProgram, Scenario};
use telemetry::{Command, RequestOutcome};
use virtual_due::WiredRig;

const SEED: u64 = 11;

/// Board time from one comparison to the next, ms; set-points are sent as often.
const LOOK_MS: u64 = 100;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let (Some(path), Some(seconds)) = (arguments.next(), arguments.next()) else {
        return Err("usage: demo SESSION.csv SECONDS".into());
    };
    let seconds: u64 = seconds.parse()?;

    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, SEED));
    // Power-on, IMUs, and a tare of one second while the arm rests.
    board.run_ms(2500);
    let program = MotionProgram::new(Scenario::FreeSwing, SEED);
    let mut view = View::new(seconds);
    if board.request(Command::Arm) != RequestOutcome::Ack {
        return Err("the board does not arm".into());
    }
    let start_s = board.machine.seconds();
    for _ in 0..seconds * 1000 / LOOK_MS {
        board.set_pressures(&program.duties(board.machine.seconds() - start_s));
        board.run_ms(LOOK_MS);
        view.show(&board);
    }
    view.finish();

    record(&board, &path)?;
    let expected = replay(&table(), board.samples());
    let equal = board.estimates().zip(&expected).filter(|(found, expected)| **found == expected.estimate).count();
    println!(
        "{equal} of {} estimates of the board are, bit for bit, the host's of the same samples",
        board.estimates().count()
    );
    Ok(())
}

/// Writes the stream since the first tare as a session, with the truth in further columns.
fn record(board: &Board, path: &str) -> Result<(), Box<dyn Error>> {
    let file = BufWriter::new(File::create(path)?);
    let mut session = SessionWriter::new(file, &Layout::default(), ImuColumns::Quaternion)?;
    for sample in board.samples().filter(|sample| sample.tare_epoch > 0) {
        let Some(truth) = board.truths().get(sample.tick as usize) else { continue };
        session.write(&Recorded {
            time_us: sample.time_us,
            counts: sample.bend.iter().copied().collect(),
            quaternions: sample.imu.iter().copied().collect(),
            truth: truth.clone(),
        })?;
    }
    Ok(())
}
