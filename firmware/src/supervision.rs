//! Supervisor of the tasks, which each of them reports to.

use board_core::Supervisor;

/// Deadlines of all tasks.
pub static SUPERVISOR: Supervisor = Supervisor::new();
