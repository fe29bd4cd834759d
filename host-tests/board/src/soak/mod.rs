//! Soak: hours of board time under random faults, with invariants that hold at all times.
//!
//! | file | contents |
//! |---|---|
//! | `run.rs` | an episode after the other: swing, faults, recovery |
//! | `draw.rs` | the faults of a seed |
//! | `host.rs` | the host that drives the arm |
//! | `truth.rs` | the true tip at each tick |
//! | `checks.rs`, `sensors.rs` | checks of the board's stream |
//! | `venting.rs` | check that the arm is vented |
//! | `finding.rs`, `known.rs`, `report.rs` | what was found |

mod checks;
mod draw;
mod finding;
mod host;
mod known;
mod report;
mod run;
mod sensors;
#[cfg(test)]
mod tests;
mod truth;
mod venting;

pub use finding::{Finding, Invariant};
pub use known::{KNOWN, Known};
pub use report::{Report, Violation};
pub use run::soak;
