//! Bodies that are read of an export.

use super::axis::Axis;

/// The bodies to read of an export, and the axis that its arm's plane is seen from.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BodySelection {
    /// Names of the bodies from the base to the tip, the base's own first where there is one; empty: all of the file, in its order.
    pub names: Vec<String>,
    /// Axis of the capture volume that points out of the arm's plane towards the viewer; `None`: the vertical one of the program.
    pub up: Option<Axis>,
}
