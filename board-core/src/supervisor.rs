//! Whether every task still does its work in time: only then is the watchdog fed.
//!
//! Each task reports when it has done its work, with the tick. Within its own number of ticks it must report again; a
//! task that has not reported yet since boot has until tick [`STARTUP_TICKS`]. Where one is late, the board stops
//! feeding the watchdog, which resets it, and the outputs with it.

use core::sync::atomic::{AtomicU32, Ordering};

/// The tick, of 10 ms, until which a task may take to report for the first time.
pub const STARTUP_TICKS: u32 = 100;

/// Tasks of the firmware, in the order in which a sample passes through them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// The tick itself: the bend sensors' scan is taken over.
    Tick,
    /// The IMUs' round.
    Imus,
    /// The estimator's step.
    Estimator,
    /// What is sent.
    Telemetry,
    /// What is received: that nothing came is a report, too.
    Link,
}

impl Task {
    const ALL: [Self; 5] = [Self::Tick, Self::Imus, Self::Estimator, Self::Telemetry, Self::Link];

    /// Most ticks of 10 ms from one report to the next.
    pub const fn deadline_ticks(self) -> u32 {
        match self {
            Self::Tick | Self::Estimator => 3,
            // A bus that is stuck is cleared within 25 ms, and the round is done after it.
            Self::Imus => 8,
            Self::Telemetry | Self::Link => 10,
        }
    }
}

/// A task that is late.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the task {0:?} is late: the watchdog is not fed, and resets the board")]
pub struct Late(pub Task);

/// When each task must report next.
///
/// Reports need no lock: tasks of any priority make them, through a shared reference.
///
/// ```
/// use board_core::{Late, Supervisor, Task};
///
/// static SUPERVISOR: Supervisor = Supervisor::new();
/// for task in [Task::Tick, Task::Imus, Task::Estimator, Task::Telemetry, Task::Link] {
///     SUPERVISOR.report(task, 0);
/// }
/// assert_eq!(SUPERVISOR.check(3), Ok(()));
/// assert_eq!(SUPERVISOR.check(4), Err(Late(Task::Tick)));
/// ```
#[derive(Debug)]
pub struct Supervisor {
    /// Last tick in which each task is in time, in the order of [`Task::ALL`].
    due: [AtomicU32; Task::ALL.len()],
}

impl Supervisor {
    /// No task has reported yet; it is tick 0.
    pub const fn new() -> Self {
        Self { due: [const { AtomicU32::new(STARTUP_TICKS) }; Task::ALL.len()] }
    }

    /// The task has done its work of this tick.
    pub fn report(&self, task: Task, tick: u32) {
        if let Some(due) = self.due.get(task as usize) {
            due.store(tick.wrapping_add(task.deadline_ticks()), Ordering::Relaxed);
        }
    }

    /// Whether all tasks are in time in this tick.
    ///
    /// # Errors
    /// Names the late task; where there are several, the one that a sample passes through first, as those behind it
    /// may only be waiting for it.
    pub fn check(&self, tick: u32) -> Result<(), Late> {
        let is_late = |due: &AtomicU32| (tick.wrapping_sub(due.load(Ordering::Relaxed)) as i32) > 0;
        let late = Task::ALL.into_iter().zip(&self.due).find(|(_, due)| is_late(due));
        late.map_or(Ok(()), |(task, _)| Err(Late(task)))
    }
}

impl Default for Supervisor {
    fn default() -> Self {
        Self::new()
    }
}
