//! Smoothing: estimates of a recorded session from all of its readings, also those after each row.
//!
//! The model is the [bias filter's](estimator_core::BiasState). A fixed-interval smoother in the modified Bryson–Frazier form
//! (Bierman 1973) runs its operations backwards, in floats, and corrects the filter's biases at every row; `docs/explanation/smoothing.md`
//! has the equations. A session with several starts of the estimator is smoothed piece by piece.
//!
//! The session is read twice. Blocks of 2048 rows are composed into one step back each, so that memory does not hold
//! the session but one block of rows, and 5 kB for each block of an arm of six segments: 22 MB for a day at 100 Hz.
//!
//! | file | purpose |
//! |---|---|
//! | `step.rs` | the operations of the filter |
//! | `covariance.rs` | P forwards, and the gains |
//! | `adjoint.rs` | λ and Λ backwards, by steps and by blocks |
//! | `correction.rs`, `headings.rs` | corrections of biases, offsets and headings |
//! | `shape.rs` | the smoothed shape and its uncertainty |
//! | `forward.rs`, `backward.rs` | the two passes |

mod adjoint;
mod backward;
mod correction;
mod covariance;
mod forward;
mod headings;
mod shape;
mod step;
#[cfg(test)]
mod tests;

use std::path::Path;

use estimator_core::FusedOps;
use proprio_session::{LoadedTable, Progress, Row};

pub use adjoint::Adjoint;
pub use backward::SmoothingPass;
pub use forward::ForwardPass;
pub use shape::Smoothed;

use crate::error::Error;
use crate::outcome::Outcome;
use crate::replay::{SessionRows, SessionSummary};

/// Replays a session with its smoothed estimates, and passes every row with its outcome to `visit`, but those from before the
/// begin of a recording.
///
/// # Errors
/// [`Error::NotSmoothed`] where the table has no bias filter; else as [`replay`](crate::replay::replay).
pub fn replay<S: FusedOps>(
    session: &Path,
    table: &LoadedTable,
    progress: &mut dyn Progress,
    mut visit: impl FnMut(&Row, &Outcome<S>) -> Result<(), Error>,
) -> Result<SessionSummary, Error> {
    if !table.has_bias_filter() {
        return Err(Error::NotSmoothed(table.path.to_owned()));
    }
    let mut rows = SessionRows::open(session, table, "first pass over", progress)?;
    let compiled = table.compile::<S>(rows.rate_hz(table)?)?;
    let config = compiled.config();
    let mut forward = ForwardPass::new(&config);
    while let Some(row) = rows.next_row()? {
        forward.add(&row);
    }
    drop(rows);
    let mut visit = |row: &Row, outcome: &Outcome<S>| if row.is_recorded() { visit(row, outcome) } else { Ok(()) };
    let mut smoothing = SmoothingPass::new(&config, forward.finish());
    let mut rows = SessionRows::open(session, table, "smoothing", progress)?;
    while let Some(row) = rows.next_row()? {
        smoothing.add(&row, &mut visit)?;
    }
    smoothing.finish(&mut visit)?;
    rows.summary(table)
}
