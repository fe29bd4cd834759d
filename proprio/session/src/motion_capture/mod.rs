//! Exports of motion-capture programs: the rigid bodies of OptiTrack Motive, of Vicon Nexus and Tracker and of Qualisys Track
//! Manager as poses in the arm's plane.
//!
//! | file | purpose |
//! |---|---|
//! | `error.rs` | [`MotionCaptureProblem`] |
//! | `axis.rs`, `rotation.rs` | axes of the capture volume; rotation of a body about one of them |
//! | `layout.rs` | columns of the bodies, as the header of any program gives them |
//! | `motive.rs`, `vicon.rs`, `qualisys.rs` | the header of each program |
//! | `selection.rs`, `reader.rs` | [`BodySelection`]; the frames |

mod axis;
mod error;
mod layout;
mod motive;
mod qualisys;
mod reader;
mod rotation;
mod selection;
#[cfg(test)]
mod tests;
mod vicon;

pub use axis::Axis;
pub use error::MotionCaptureProblem;
pub(crate) use reader::{BodyFrame, MotionCaptureReader};
pub use selection::BodySelection;
