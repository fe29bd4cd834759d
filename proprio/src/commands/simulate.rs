//! `proprio simulate`.

use proprio::error::Error;
use proprio::output::OutputFile;
use proprio::progress::Progress;
use proprio::session::SessionWriter;
use proprio::simulate::Simulation;
use rig_twin::Scenario;

use crate::cli::{ScenarioName, Simulate};

pub fn run(args: &Simulate) -> Result<(), Error> {
    let simulation = Simulation::new(args.scenario.into(), args.seed, args.seconds, args.rate)?;
    let mut file = OutputFile::create(&args.output, &[])?;
    let mut progress = Progress::new("simulating".to_owned(), simulation.samples());
    write(&mut file, args, simulation, &mut progress).map_err(|error| file.error(error))?;
    file.finish()
}

fn write(file: &mut OutputFile, args: &Simulate, run: Simulation, progress: &mut Progress) -> std::io::Result<()> {
    let mut session = SessionWriter::new(file, args.imu)?;
    for (done, sample) in (1..).zip(run) {
        session.write(&sample)?;
        progress.set(done);
    }
    Ok(())
}

impl From<ScenarioName> for Scenario {
    fn from(name: ScenarioName) -> Self {
        match name {
            ScenarioName::One => Self::One,
            ScenarioName::Two => Self::Two,
            ScenarioName::Three => Self::Three,
            ScenarioName::Sweep => Self::Sweep,
        }
    }
}
