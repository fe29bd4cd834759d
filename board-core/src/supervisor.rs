//! Supervisor of the tasks' deadlines: the watchdog is fed only while every task meets its deadline.
//!
//! Each task reports when it has done its work of a tick, and must report again within its deadline; a task that has not
//! reported since boot has until tick [`STARTUP_TICKS`]. After a missed deadline the board stops feeding the watchdog,
//! which resets the board and its outputs.

use core::sync::atomic::{AtomicU32, Ordering};

/// Deadline of each task's first report, ticks of 10 ms.
pub const STARTUP_TICKS: u32 = 100;

/// Tasks of the firmware, in the order in which a sample passes through them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// The tick itself, with the bend sensors' scan.
    Tick,
    /// The IMUs' round.
    Imus,
    /// The estimator's step.
    Estimator,
    /// The sender of messages.
    Telemetry,
    /// The receiver of requests; it also reports in ticks without one.
    Commands,
}

impl Task {
    const ALL: [Self; 5] = [Self::Tick, Self::Imus, Self::Estimator, Self::Telemetry, Self::Commands];

    /// Deadline from one report to the next, ticks of 10 ms.
    pub const fn deadline_ticks(self) -> u32 {
        match self {
            Self::Tick | Self::Estimator => 3,
            // A bus that is stuck is cleared within 25 ms, and the round is done after it.
            Self::Imus => 8,
            Self::Telemetry | Self::Commands => 10,
        }
    }
}

/// A task that missed its deadline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the task {0:?} is late: the watchdog is not fed, and resets the board")]
pub struct DeadlineMissed(pub Task);

/// Deadline of each task's next report.
///
/// Reports need no lock: tasks of any priority make them, through a shared reference.
///
/// ```
/// use board_core::{DeadlineMissed, Supervisor, Task};
///
/// static SUPERVISOR: Supervisor = Supervisor::new();
/// for task in [Task::Tick, Task::Imus, Task::Estimator, Task::Telemetry, Task::Commands] {
///     SUPERVISOR.report(task, 0);
/// }
/// assert_eq!(SUPERVISOR.check(3), Ok(()));
/// assert_eq!(SUPERVISOR.check(4), Err(DeadlineMissed(Task::Tick)));
/// ```
#[derive(Debug)]
pub struct Supervisor {
    /// Last tick that meets each task's deadline, in the order of [`Task::ALL`].
    deadlines: [AtomicU32; Task::ALL.len()],
}

impl Supervisor {
    /// A supervisor at tick 0, before any report.
    pub const fn new() -> Self {
        Self { deadlines: [const { AtomicU32::new(STARTUP_TICKS) }; Task::ALL.len()] }
    }

    /// Reports that the task has done its work of this tick.
    pub fn report(&self, task: Task, tick: u32) {
        if let Some(deadline) = self.deadlines.get(task as usize) {
            deadline.store(tick.wrapping_add(task.deadline_ticks()), Ordering::Relaxed);
        }
    }

    /// Checks the deadlines of all tasks in this tick.
    ///
    /// # Errors
    /// [`DeadlineMissed`] with the task; of several tasks the one that a sample passes through first, as those after it
    /// may only be waiting for it.
    pub fn check(&self, tick: u32) -> Result<(), DeadlineMissed> {
        let is_late = |deadline: &AtomicU32| (tick.wrapping_sub(deadline.load(Ordering::Relaxed)) as i32) > 0;
        let late = Task::ALL.into_iter().zip(&self.deadlines).find(|(_, deadline)| is_late(deadline));
        late.map_or(Ok(()), |(task, _)| Err(DeadlineMissed(task)))
    }
}

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
    }
}
