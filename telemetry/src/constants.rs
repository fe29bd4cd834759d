//! Constants of the protocol and of the largest arm.

/// Version of this protocol: the first byte of every frame. Frame, COBS and CRC stay as they are in every version.
pub const PROTOCOL_VERSION: u8 = 3;

/// Length of the longest frame in bytes, its zero included.
pub const MAX_FRAME: usize = 255;

/// Longest piece of a table in one frame, bytes: the frame takes 7 ms of the line, less than a tick.
pub const TABLE_CHUNK_BYTES: usize = 160;

/// Time between two ticks of the board, µs.
pub const TICK_US: u64 = 10_000;

/// Ticks a second: the rate of samples and estimates, unless the host requests a lower one.
pub const TICK_HZ: f64 = 1e6 / TICK_US as f64;

/// Segments of the longest arm.
pub const MAX_SEGMENTS: usize = 8;

/// Places for bend sensors on a segment, a and b.
pub const BEND_PER_SEGMENT: usize = 2;

/// Places for bend sensors on the longest arm, in the order 1a, 1b, 2a … 8b.
pub const MAX_BEND_SENSORS: usize = MAX_SEGMENTS * BEND_PER_SEGMENT;

/// Pressure regulators of the largest arm.
pub const MAX_REGULATORS: usize = 8;
