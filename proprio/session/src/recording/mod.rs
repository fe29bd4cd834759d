//! Recordings: everything that a board said, as an [MCAP](https://mcap.dev) file.
//!
//! The channel [`RAW`] has the bytes as they came, each message with the time of its arrival: the truth of what was
//! received, and what a replay decodes again. The other channels are for people and their programs: ROS 2 messages in CDR.
//! `docs/reference/files.md` lists them.
//!
//! | file | what it is for |
//! |---|---|
//! | `writer.rs` | a recording that is being made |
//! | `reader.rs` | one that is read, bytes and truth |
//! | `rows.rs` | bytes to the samples of a session |
//! | `recover.rs` | what is whole of a file that was cut |
//! | `messages.rs`, `schema.rs`, `cdr.rs` | ROS 2 messages |

mod cdr;
mod messages;
mod reader;
mod recover;
mod rows;
mod schema;
mod writer;

pub use messages::chip_number;
pub use reader::{Item, RawReader, ReadError, Reader, is_recording};
pub use recover::{RecoverError, Recovery, recover};
pub(crate) use rows::RecordedRows;
pub use writer::Recorder;

/// Topic of the bytes as they came.
pub const RAW: &str = "/proprio/raw";
/// Topic of `proprio_msgs/msg/Sample`.
pub const SAMPLES: &str = "/proprio/samples";
/// Topic of `sensor_msgs/msg/JointState`.
pub const JOINT_STATES: &str = "/joint_states";
/// Topic of `geometry_msgs/msg/PoseArray`.
pub const SHAPE: &str = "/proprio/shape";
/// Topic of `proprio_msgs/msg/Uncertainty`.
pub const UNCERTAINTY: &str = "/proprio/uncertainty";
/// Topic of `proprio_msgs/msg/Contact`.
pub const CONTACT: &str = "/proprio/contact";
/// Topic of `diagnostic_msgs/msg/DiagnosticArray`.
pub const DIAGNOSTICS: &str = "/diagnostics";
/// Topic of `proprio_msgs/msg/SetPoints`.
pub const SET_POINTS: &str = "/proprio/set_points";
/// Topic of `proprio_msgs/msg/Truth`.
pub const TRUTH: &str = "/proprio/truth";
/// Topic of `std_msgs/msg/String`: moments that a person has marked.
pub const MARKS: &str = "/proprio/marks";
