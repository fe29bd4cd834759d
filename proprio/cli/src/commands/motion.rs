//! Motion of an emulated board's arm: the host drives the pressures by the program of the scenario.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep};
use std::time::Instant;

use board_table::REFERENCE_FULL_SCALE_PA;
use proprio_link::drive::{Driver, PERIOD};
use proprio_link::status::Status;
use proprio_link::{Link, LinkError};
use proprio_session::LoadedTable;
use rig_twin::{Layout, MotionProgram, REST_S, Scenario, Setup};

use crate::args::LinkArgs;
use crate::error::Error;
use crate::terminal;

/// An arm that moves until this is dropped.
#[derive(Debug)]
pub struct Motion {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Pressures over time.
struct Pressures {
    program: MotionProgram,
    /// Pressure of each regulator at full duty, Pa.
    full_scales_pa: Vec<f64>,
}

impl Motion {
    /// Moves the arm of an emulated board as soon as it is tared. An error ends the motion with a warning.
    pub fn start(link: Link, args: &LinkArgs) -> Result<Self, Error> {
        let pressures = Pressures::of(args)?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let work = move || {
            if let Err(error) = drive(&link, &pressures, &stopped)
                && !stopped.load(Ordering::Relaxed)
            {
                terminal::warn(&format_args!("the simulated arm is not moved any more: {error}"));
            }
        };
        let thread = std::thread::Builder::new().name("motion".to_owned()).spawn(work).map_err(LinkError::Thread)?;
        Ok(Self { stop, thread: Some(thread) })
    }
}

impl Drop for Motion {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Pressures {
    fn of(args: &LinkArgs) -> Result<Self, Error> {
        let scenario = match args.scenario {
            2 => Scenario::Push,
            3 => Scenario::Obstacle,
            _ => Scenario::FreeSwing,
        };
        let setup = Setup::new(scenario, args.seed);
        let Some(path) = args.arm.as_deref().or(args.table.as_deref()) else {
            let regulators = setup.layout.regulators();
            let full_scales_pa = vec![f64::from(REFERENCE_FULL_SCALE_PA); regulators];
            return Ok(Self { program: MotionProgram::of(&setup), full_scales_pa });
        };
        let file = LoadedTable::load(path)?.file;
        let layout = Layout::of_file(&file).map_err(|source| Error::Layout { path: path.to_owned(), source })?;
        let reference = vec![f64::from(REFERENCE_FULL_SCALE_PA); layout.regulators()];
        let given = |board: &calibration_tables::BoardToml| {
            board.regulators.iter().map(|regulator| regulator.full_scale_kpa * 1e3).collect()
        };
        let full_scales_pa = file.board.as_ref().map_or(reference, given);
        Ok(Self { program: MotionProgram::of(&Setup { layout, ..setup }), full_scales_pa })
    }

    /// The pressures at a time since the begin of the motion, Pa.
    fn at(&self, time_s: f64) -> Vec<u32> {
        let duties = self.program.duties(REST_S + time_s);
        self.full_scales_pa.iter().zip(&duties).map(|(full_pa, duty)| (full_pa * duty).round() as u32).collect()
    }
}

fn drive(link: &Link, pressures: &Pressures, stop: &AtomicBool) -> Result<(), Error> {
    // The board is tared when its status is known.
    let status = Status::of(link, &link.subscribe(), false)?;
    let regulators = pressures.full_scales_pa.len();
    if regulators == 0 {
        return Ok(());
    }
    let mut driver = Driver::arm(link, &status, regulators)?;
    let start = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        driver.set(pressures.at(start.elapsed().as_secs_f64()))?;
        sleep(PERIOD);
    }
    Ok(driver.vent()?)
}
