//! Constants of the protocol and of the arm.

/// Version of this protocol: the first byte of every frame. Frame, COBS and CRC stay as they are in every version.
pub const PROTOCOL_VERSION: u8 = 2;

/// Length of the longest frame in bytes, its zero included.
pub const MAX_FRAME: usize = 255;

/// Longest piece of a table in one frame, bytes: the frame takes 7 ms of the line, less than a tick.
pub const TABLE_CHUNK_BYTES: usize = 160;

/// Time between two ticks of the board, µs.
pub const TICK_US: u64 = 10_000;

/// Ticks a second: the rate of samples and estimates, unless the host requests a lower one.
pub const TICK_HZ: f64 = 1e6 / TICK_US as f64;

/// Segments of the arm.
pub const SEGMENTS: usize = 6;

/// Bend sensors of the arm, in the order 1a, 1b, 2a … 6b.
pub const BEND_SENSORS: usize = 12;

/// Pressure regulators of the arm: module 1 right, left, module 2 right, left, module 3 right, left.
pub const REGULATORS: usize = 6;
