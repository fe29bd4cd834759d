//! What users rely on of the firmware, on the emulated board.

mod boot;
mod engine;
mod faults;
mod last_words;
mod pressures;
#[cfg(unix)]
mod recording;
mod replay;
mod requests;
mod sensors;
