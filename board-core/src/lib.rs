//! Logic of the arm's board, independent of its hardware.
//!
//! The firmware accesses pins and buses and moves bytes; the decisions are made here, in `no_std` code that depends on no
//! chip and is tested on a host. Each part is a state machine that the firmware advances once a tick of 10 ms. None has a
//! clock: the caller gives the tick's number, or the time since boot in µs, so that the same inputs give the same
//! outputs.
//!
//! | part | task |
//! |---|---|
//! | [`imus`] | polling and validation of the IMUs |
//! | [`bno055`], [`tca9548a`] | drivers of an IMU and of the multiplexer before it |
//! | [`BendSensorMonitor`] | rail detection and debounced states of the bend sensors |
//! | [`RestMonitor`] | range of the headings before a tare |
//! | [`CommandServer`] | idempotent requests and their rate limit |
//! | [`TableServer`] | requests about the table in the flash |
//! | [`Schedule`] | periods of the messages |
//! | [`Actuator`] | arming, set-points with a deadline, venting |
//! | [`Supervisor`] | the tasks' deadlines, for the watchdog |
//! | [`BootCounter`] | detection of a boot loop |
//!
//! No input from outside can cause a panic.
#![no_std]

mod actuation;
mod bend_sensors;
pub mod bno055;
mod boot_counter;
mod command_server;
mod gap_counter;
pub mod imus;
mod rest_monitor;
mod schedule;
mod supervisor;
mod table_server;
pub mod tca9548a;

pub use actuation::{Actuator, HOLD_MS, Pressures, VALID_MS_MAX, VENTED_MS};
pub use bend_sensors::{BendSensorMonitor, LOSS_TICKS, RAIL_COUNTS, RETURN_TICKS, Scan};
pub use boot_counter::{BootCounter, CRASHES, RETAINED_WORDS, UPTIME_WORD, WINDOW_TICKS};
pub use command_server::{BUCKET_SIZE, CommandServer, Execution, REFILL_PER_TICK, SESSION_TIMEOUT_TICKS};
pub use rest_monitor::{REST_RANGE, RestMonitor};
pub use schedule::{DueMessages, Schedule};
pub use supervisor::{DeadlineMissed, STARTUP_TICKS, Supervisor, Task};
pub use table_server::{TableAnswer, TableServer};
