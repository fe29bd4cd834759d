//! Versions of the firmware that has made a recording.

/// Prefix of the firmware versions whose estimates and uncertainties differ in part.
const VERSION_0_1: &str = "0.1.";

/// True for firmware of version 0.1, in which the same table has another checksum.
#[must_use]
pub fn is_version_0_1(firmware: &str) -> bool {
    firmware.starts_with(VERSION_0_1)
}
