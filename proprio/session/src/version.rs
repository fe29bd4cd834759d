//! Versions of the firmware that a recording was made by.

/// First numbers of the firmware's version whose estimates and uncertainties are others in part.
const VERSION_0_1: &str = "0.1.";

/// Whether firmware of this version is of version 0.1. The same table has another checksum there.
#[must_use]
pub fn is_version_0_1(firmware: &str) -> bool {
    firmware.starts_with(VERSION_0_1)
}
