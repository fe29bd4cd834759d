//! Behaviour of the firmware that users rely on, tested on the emulated board.

mod arms;
mod boot;
mod demo;
#[cfg(unix)]
mod drive;
mod engine;
mod fault_rows;
mod faults;
#[cfg(unix)]
mod flash;
mod last_words;
#[cfg(unix)]
mod late_recording;
#[cfg(unix)]
mod link;
#[cfg(unix)]
mod monitored_line;
mod noise;
mod page;
mod page_table;
mod pressures;
#[cfg(unix)]
mod recording;
mod replay;
mod requests;
mod sensors;
mod soak;
mod table;
mod tare;
#[cfg(unix)]
mod terminal;
#[cfg(unix)]
mod tools;
mod touch;
