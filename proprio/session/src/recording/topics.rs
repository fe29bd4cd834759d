//! Topics of a recording's channels.

/// Topic of the received bytes.
pub const RAW: &str = "/proprio/raw";
/// Topic of the bytes received before the begin of the recording, from the last start of the board's estimator on.
pub const HISTORY: &str = "/proprio/history";
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
/// Topic of `std_msgs/msg/String`: marks that a person has set.
pub const MARKS: &str = "/proprio/marks";
