//! The bias filter's model: a Kalman filter over all IMUs and segments at once.
//!
//! States: of each IMU j its heading's bias β_j and the bias's rate v_j, of each segment i the offset o_i of its bend
//! sensors in this session.
//!
//! | | |
//! |---|---|
//! | model | β̇ = v + white noise, v̇ = white noise, o a Gauss–Markov process |
//! | measurement | z_i = θ_imu,i − θ_bend,i = β_i − β_{i−1} − o_i + noise |
//!
//! The covariance is that of all states, because an error of one heading enters two bend angles with opposite signs:
//! the error of one angle is cancelled by the next, and hardly moves the tip.
//!
//! Each IMU and its segment are predicted in a sample of their own, so that the cost is spread over the samples.

mod pending;
mod state;
mod update;

pub use pending::Row;
pub use state::{BIAS, BiasState, LONGEST_PREDICTION_US, OFFSET, RATE};
pub use update::Innovation;
