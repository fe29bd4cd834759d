//! Arms that fit the board: the description of a new one, and what `check` prints of one.
//!
//! | file | purpose |
//! |---|---|
//! | `choice.rs`, `error.rs` | segments, sensors and regulators of a new arm, and their limits |
//! | `questions.rs` | options that are asked for |
//! | `description.rs` | the text of its arm description |
//! | `line_budget.rs` | load of the serial line by an arm |
//! | `summary.rs` | wiring, counts and load of the line, as text and as JSON |

mod choice;
mod description;
mod error;
mod line_budget;
mod questions;
mod summary;

pub use choice::NewArm;
pub use description::description;
pub use error::NewArmError;
pub use questions::{Question, answer, answer_or};
pub use summary::{ArmSummary, REFERENCE_WIRING, wiring_table};
