//! Problems of a motion-capture program's export.

/// A problem of an export, or of the bodies that are selected of it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MotionCaptureProblem {
    /// The header ends before its columns.
    #[error("the header of this export ends before the names of its columns")]
    Header,
    /// There is no rigid body with position and rotation.
    #[error("the export has no rigid body with a position and a rotation")]
    NoBodies,
    /// A unit of length, angle or rate, or an order of rotation that is not known.
    #[error("\"{0}\" is no known unit or rotation of this program")]
    Unit(String),
    /// The number of bodies is not that of the arm.
    #[error("{} bodies ({}), expected {segments}, one at each segment's end, or {} with the base before them",
        found.len(), found.join(", "), segments + 1)]
    Count {
        /// Names of the bodies.
        found: Vec<String>,
        /// Segments of the arm.
        segments: usize,
    },
    /// A body that is not in the file.
    #[error("has no body \"{name}\"; it has {}", found.join(", "))]
    Unknown {
        /// Its name.
        name: String,
        /// Names of the file's bodies.
        found: Vec<String>,
    },
    /// A body that is selected twice.
    #[error("the body \"{0}\" is given twice")]
    Twice(String),
    /// Bodies or an axis of a file that is no export.
    #[error("is no export of a motion-capture program, expected one, as bodies or an axis are given")]
    NotAnExport,
}
