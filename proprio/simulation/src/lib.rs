//! Sessions of the simulated arm, as they are recorded: samples with truth, and what a camera sees.

mod error;
mod simulation;
mod writer;

pub use error::SimulationError;
pub use simulation::{Recorded, Simulation};
pub use writer::{CameraWriter, ImuColumns, SessionWriter};
