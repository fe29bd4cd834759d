//! Exports of motion-capture programs: the rigid bodies of OptiTrack Motive, of Vicon Nexus and Tracker and of Qualisys Track
//! Manager as poses in the arm's plane.
//!
//! | file | purpose |
//! |---|---|
//! | `error.rs` | [`MotionCaptureProblem`] |
//! | `axis.rs`, `rotation.rs` | axes of the capture volume; rotation of a body about one of them |
//! | `layout.rs` | columns of the bodies, as the header of any program gives them |
//! | `motive.rs`, `vicon.rs`, `qualisys.rs` | the header of each program |
//! | `reader.rs` | the frames |

mod axis;
mod error;
mod layout;
mod motive;
mod qualisys;
mod reader;
mod rotation;
#[cfg(test)]
mod tests;
mod vicon;

pub use axis::Axis;
pub use error::MotionCaptureProblem;
pub use reader::MotionCaptureReader;

/// The bodies to read of an export, and the axis that its arm's plane is seen from.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BodySelection {
    /// Names of the bodies from the base to the tip, the base's own first where there is one; empty: all of the file, in its order.
    pub names: Vec<String>,
    /// Axis of the capture volume that points out of the arm's plane towards the viewer; `None`: the vertical one of the program.
    pub up: Option<Axis>,
}
