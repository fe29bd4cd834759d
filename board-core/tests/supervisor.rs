//! The watchdog is fed only while every task meets its deadline.

use board_core::{DeadlineMissed, STARTUP_TICKS, Supervisor, Task};

const TASKS: [Task; 5] = [Task::Tick, Task::Imus, Task::Estimator, Task::Telemetry, Task::Commands];

fn all_reported(tick: u32) -> Supervisor {
    let supervisor = Supervisor::new();
    for task in TASKS {
        supervisor.report(task, tick);
    }
    supervisor
}

#[test]
fn tasks_that_report_every_tick_are_in_time_at_all_ticks() {
    let supervisor = Supervisor::new();
    // Across the wrap of the tick, after 497 days.
    for tick in (0..2000).chain(u32::MAX - 1000..=u32::MAX).chain(0..1000) {
        for task in TASKS {
            supervisor.report(task, tick);
        }
        assert_eq!(supervisor.check(tick), Ok(()));
    }
}

#[test]
fn a_task_that_stops_is_named_after_its_deadline() {
    for stuck in TASKS {
        let supervisor = all_reported(1000);
        for tick in 1001..=1000 + stuck.deadline_ticks() + 1 {
            for task in TASKS {
                if task != stuck {
                    supervisor.report(task, tick);
                }
            }
            let in_time = tick <= 1000 + stuck.deadline_ticks();
            assert_eq!(
                supervisor.check(tick),
                if in_time { Ok(()) } else { Err(DeadlineMissed(stuck)) },
                "tick {tick}"
            );
        }
    }
}

#[test]
fn every_stuck_task_is_noticed_within_100_ms() {
    assert!(TASKS.into_iter().all(|task| task.deadline_ticks() <= 10));
}

#[test]
fn of_several_late_tasks_the_first_on_a_samples_way_is_named() {
    let supervisor = all_reported(0);
    supervisor.report(Task::Tick, 500);
    assert_eq!(supervisor.check(500), Err(DeadlineMissed(Task::Imus)));
}

#[test]
fn a_task_has_the_start_up_time_for_its_first_report() {
    let supervisor = Supervisor::new();
    assert_eq!(supervisor.check(STARTUP_TICKS), Ok(()));
    assert_eq!(supervisor.check(STARTUP_TICKS + 1), Err(DeadlineMissed(Task::Tick)));
}

#[test]
fn a_task_that_has_reported_once_has_no_grace_left() {
    let supervisor = Supervisor::new();
    supervisor.report(Task::Imus, 0);
    assert_eq!(supervisor.check(Task::Imus.deadline_ticks()), Ok(()));
    assert_eq!(supervisor.check(Task::Imus.deadline_ticks() + 1), Err(DeadlineMissed(Task::Imus)));
}

#[test]
fn a_late_task_that_reports_again_is_in_time() {
    let supervisor = all_reported(0);
    assert!(supervisor.check(500).is_err());
    for task in TASKS {
        supervisor.report(task, 500);
    }
    assert_eq!(supervisor.check(500), Ok(()));
}
