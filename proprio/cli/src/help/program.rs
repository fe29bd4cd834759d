//! Remedies of the errors that join those of the libraries.

use proprio_monitor::RunningMonitorError;
use proprio_simulation::SimulationError;

use super::Help;
use crate::arm::NewArmError;
use crate::error::Error;

impl Help for Error {
    fn help(&self) -> String {
        let help = match self {
            Self::File(error) => return error.help(),
            Self::Analysis(error) => return error.help(),
            Self::Calibration(error) => return error.help(),
            Self::Monitor(error) => return error.help(),
            Self::RunningMonitor(RunningMonitorError::Moving(_)) => "let it rest, or use --force",
            Self::RunningMonitor(_) => "see its page, or end it and try again",
            Self::NoStream(_) => "start the monitor with --foxglove",
            Self::Foxglove(proprio_foxglove::Error::Listen { .. }) => {
                "give another with --foxglove=PORT; does another program stream to Foxglove already?"
            }
            Self::Link(error) => return error.help(),
            Self::Drive(error) => return error.help(),
            Self::Flash(error) => return error.help(),
            Self::TableImage { source, .. } => return source.help(),
            Self::Transfer(error) => return error.help(),
            Self::Tare(error) => return error.help(),
            Self::Layout { .. } => "simulate an arm of 1 to 8 segments",
            Self::NewArm(error) => return error.help(),
            Self::OutputTwice(_) => "give the output another name",
            Self::Stdout(_) => "write to a disk with free space, or use --out",
            Self::SessionWithoutTable | Self::CheckWithoutTable(_) => "give the arm's table with --table",
            Self::NoChannel { .. } => "give --out a name that ends with .csv",
            Self::EstimatesOfConversion { .. } => {
                "leave out --table; `proprio replay --out EST.mcap` writes the estimates of any session"
            }
            Self::OneSession(_) => "replay the sessions one by one",
            Self::Simulation(SimulationError::Fault(_)) => {
                "give faults of sensors that the arm has; docs/reference/faults.md lists them"
            }
            Self::Simulation(_) | Self::Seconds(_) | Self::Pressure(_) | Self::Ramp(_) => "give a value in this range",
        };
        help.to_owned()
    }
}

impl Help for NewArmError {
    fn help(&self) -> String {
        let help = match self {
            Self::Missing(_) | Self::Answer { .. } => "give it, such as --lengths-mm 90,90,80 --bend 2,2,1",
            Self::Number { .. } => "write numbers with commas between them, such as 90,90,80",
            Self::BendSegments { .. } => "give a number for each segment, 0 where it has no bend sensor",
            Self::Segments(_) | Self::BendSensors(_) | Self::Regulators(_) => {
                "describe the part of the arm that the board has room for; a host alone can replay and monitor a larger one"
            }
            Self::Length { .. } | Self::SegmentSensors { .. } | Self::FullScale(_) => "give a value in this range",
        };
        help.to_owned()
    }
}

impl Help for proprio_session::Error {
    fn help(&self) -> String {
        let help = match self {
            Self::Session(error) => return error.problem.help(),
            Self::Table { source, .. } => return source.help(),
            Self::Output { .. } => "choose a folder that exists, can be written to and has room",
            Self::Overwrite(_) | Self::RecordingExists(_) => "give the output another name",
            Self::Exists(_) => "give the output another name, or replace the file with --force",
            Self::OutputKind(_) => "give the output one of these endings",
            Self::SameKind(_) => "copy the file, or give the output another ending",
        };
        help.to_owned()
    }
}

impl Help for proprio_analysis::Error {
    fn help(&self) -> String {
        match self {
            Self::File(error) => error.help(),
            Self::NotSmoothed(_) => {
                "calibrate a table with the bias filter, `[drift] kind = \"kalman\"`, or leave out --smooth".to_owned()
            }
            Self::OtherArm(_) => "compare tables of one arm, or make a report with each".to_owned(),
        }
    }
}

impl Help for proprio_calibration::Error {
    fn help(&self) -> String {
        match self {
            Self::File(error) => error.help(),
            Self::Replay(error) => error.help(),
            Self::Truth { source, .. } => source.help(),
            Self::Calibration { source, .. } => source.help(),
            Self::Tuning { source, .. } => source.help(),
            Self::Alignment { source, .. } => source.help(),
        }
    }
}

impl Help for proprio_monitor::Error {
    fn help(&self) -> String {
        match self {
            Self::File(error) => error.help(),
            Self::Link(error) => error.help(),
            Self::TableImage(error) => error.help(),
            Self::Transfer(error) => error.help(),
            Self::NoTable => "give the arm's table with --table".to_owned(),
            Self::NoSuchTable(_) => "copy it there, or start the monitor with --folder".to_owned(),
            Self::RecorderPanicked(_) => {
                "save it with `proprio recover`, and report the fault, with the message above and the command"
                    .to_owned()
            }
            Self::Listen { .. } => "give another with --listen; is a monitor running already?".to_owned(),
            Self::Random(_) => "run the monitor without --allow-control".to_owned(),
        }
    }
}
