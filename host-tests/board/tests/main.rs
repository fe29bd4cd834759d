//! What users rely on of the firmware, on the emulated board.

mod boot;
