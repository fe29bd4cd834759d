//! Faults of a rig, injected by name: of its sensors here, of bus, memory, power and line in the emulated board.
//!
//! | file | contents |
//! |---|---|
//! | `fault.rs` | [`Fault`] |
//! | `forms.rs` | name, value, unit and effect of every fault |
//! | `name.rs` | parser and printer of the names |
//! | `timed.rs` | [`TimedFault`]: a fault with its begin and end |
//! | `sensors.rs`, `imu.rs` | effect on the simulated sensors |

mod error;
mod fault;
mod forms;
mod imu;
mod name;
mod sensors;
mod timed;

pub use error::FaultError;
pub use fault::{BendPlace, Fault, Hold, SegmentNumber};
pub use forms::reference_table;
pub(crate) use imu::ImuFaults;
pub(crate) use sensors::SensorFaults;
pub use timed::{TimedFault, parse_schedule};
