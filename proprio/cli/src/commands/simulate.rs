//! `proprio simulate`.

use std::io;
use std::path::Path;

use proprio_session::{LoadedTable, OutputFile, Progress};
use proprio_simulation::{CameraWriter, ImuColumns, SessionWriter, Simulation};
use rig_twin::{Camera, Layout, Motion, Scenario, Setup};

use crate::args::{ImuName, MotionName, ScenarioName, SimulateArgs};
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &SimulateArgs) -> Result<(), Error> {
    let setup = Setup {
        arm_seed: args.arm_seed,
        layout: args.arm.as_deref().map_or_else(|| Ok(Layout::default()), layout)?,
        scenario: args.scenario.into(),
        motion: args.motion.into(),
        seed: args.seed,
    };
    let mut simulation = Simulation::of(&setup, args.seconds, args.rate)?;
    for fault in &args.fault {
        simulation = simulation.with_fault(*fault)?;
    }
    if args.camera.as_ref() == Some(&args.output) {
        return Err(Error::OutputTwice(args.output.clone()));
    }
    let file = OutputFile::create(&args.output, &[], args.force.existing())?;
    let mut session = match &args.camera {
        None => SessionWriter::new(file, &setup.layout, args.imu.into()),
        Some(_) => SessionWriter::without_truth(file, &setup.layout, args.imu.into()),
    }
    .map_err(to_write(&args.output))?;
    let mut camera = None;
    if let Some(path) = &args.camera {
        let file = OutputFile::create(path, &[], args.force.existing())?;
        camera = Some(CameraWriter::new(file, setup.layout.segments().len()).map_err(to_write(path))?);
        simulation = simulation.under(Camera::new(args.seed));
    }

    let (mut progress, total) = (Bar::new(), simulation.samples());
    let mut done = 0;
    while let Some(sample) = simulation.next() {
        session.write(&sample).map_err(to_write(&args.output))?;
        if let Some((camera, path)) = camera.as_mut().zip(args.camera.as_ref()) {
            let mut frames = simulation.take_frames().into_iter();
            frames.try_for_each(|frame| camera.write(&frame)).map_err(to_write(path))?;
        }
        done += 1;
        progress.advance("simulating", (done, total));
    }
    drop(progress);
    for file in camera.map(CameraWriter::into_inner).into_iter().chain([session.into_inner()]) {
        terminal::eprint_line(&file.finish()?);
    }
    Ok(())
}

/// Layout of the arm of a file.
fn layout(path: &Path) -> Result<Layout, Error> {
    let arm = LoadedTable::load(path)?;
    Layout::of_file(&arm.file).map_err(|source| Error::Layout { path: path.to_owned(), source })
}

/// The error of a file that cannot be written.
fn to_write(path: &Path) -> impl Fn(io::Error) -> Error {
    move |source| proprio_session::Error::Output { path: path.to_owned(), source }.into()
}

impl From<MotionName> for Motion {
    fn from(name: MotionName) -> Self {
        match name {
            MotionName::Swings => Self::Swings,
            MotionName::Slow => Self::Slow,
            MotionName::Fast => Self::Fast,
            MotionName::OneModule => Self::OneModule,
            MotionName::Rests => Self::Rests,
            MotionName::Lean => Self::Lean,
            MotionName::BentStart => Self::BentStart,
            MotionName::MovingStart => Self::MovingStart,
        }
    }
}

impl From<ScenarioName> for Scenario {
    fn from(name: ScenarioName) -> Self {
        match name {
            ScenarioName::One => Self::FreeSwing,
            ScenarioName::Two => Self::Push,
            ScenarioName::Three => Self::Obstacle,
            ScenarioName::Sweep => Self::Sweep,
        }
    }
}

impl From<ImuName> for ImuColumns {
    fn from(name: ImuName) -> Self {
        match name {
            ImuName::Deg => Self::Deg,
            ImuName::Quaternion => Self::Quaternion,
        }
    }
}
