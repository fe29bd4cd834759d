//! Recorded sessions of the simulated arm: samples with truth, and the frames of a camera.

mod error;
mod simulation;
mod writer;

pub use error::SimulationError;
pub use simulation::{Recorded, Simulation};
pub use writer::{CameraWriter, ImuColumns, SessionWriter};
