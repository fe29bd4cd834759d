//! Poses of the truth that are wrong.

use crate::check::finding::Rows;

/// Wrong poses of one segment's end in consecutive rows.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    /// The segment, from 0.
    pub segment: usize,
    /// The rows.
    pub rows: Rows,
    /// Kind of the fault.
    pub kind: FaultKind,
}

/// Kind of wrong poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// Exact zeros, as for a marker that was not seen.
    Zeros,
    /// The last pose is repeated while the arm moves.
    Repeated,
    /// All poses are repeated while the arm moves.
    AllRepeated,
    /// A single row is off its neighbours in time, which agree.
    Jump,
    /// The place is further from that of a neighbour than the arm allows.
    Misplaced,
    /// The pose is that of another segment's end, from 0.
    Exchanged(usize),
}
