//! What the arm's board does beside estimating, without the board.
//!
//! The firmware reads pins and buses and moves bytes; what it makes of them is decided here, in `no_std` code that
//! knows no chip and is tested on a host. Each part is a state machine that the firmware advances once a tick of 10 ms.
//! None keeps a clock: the caller gives the tick's number, or the time since boot in µs, so that the same inputs give
//! the same outputs.
//!
//! | part | what it decides |
//! |---|---|
//! | [`imus`] | which IMU is read in a tick, and which are to be trusted |
//! | [`bno055`], [`tca9548a`] | how an IMU, and the multiplexer before it, are spoken to |
//! | [`Bends`] | which bend sensors are to be trusted |
//! | [`Arm`] | what the estimator is fed, and when it starts anew |
//! | [`Link`] | which of the host's requests are done, and what each is answered |
//! | [`Schedule`] | which messages are due |
//! | [`Actuator`] | what may move the pressures, and how they end vented |
//! | [`Supervisor`] | whether the watchdog is fed |
//! | [`Boots`] | whether the board is in a boot loop |
//!
//! Nothing here can panic on what comes from outside.
#![no_std]

mod actuation;
mod arm;
mod bends;
pub mod bno055;
mod boots;
pub mod imus;
mod link;
mod schedule;
mod supervisor;
pub mod tca9548a;

pub use actuation::{Actuator, FULL_SCALE_PA, HOLD_MS, VALID_MS_MAX, VENTED_MS};
pub use arm::{Arm, TARE_TICKS};
pub use bends::{Bends, LOSS_TICKS, RAIL_COUNTS, RETURN_TICKS};
pub use boots::{Boots, CRASHES, UPTIME_WORD, WINDOW_TICKS, WORDS};
pub use link::{ANEW_TICKS, BURST, Link, PER_TICK};
pub use schedule::{DEFAULT_RATES, Due, HELLO_TICKS, Schedule};
pub use supervisor::{Late, STARTUP_TICKS, Supervisor, Task};
