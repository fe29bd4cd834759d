//! The command-line tool as its users meet it: what it accepts, what it refuses and how, and what it writes.

mod accepted_sessions;
mod align;
mod align_faults;
mod bad_cells;
mod bad_sessions;
mod board;
mod calibrate;
mod calibrate_faults;
mod calibrate_gaps;
mod check;
mod check_elsewhere;
mod common;
mod convert;
mod damaged_recordings;
mod drive;
mod earlier_schema;
mod estimates;
mod figures;
#[cfg(unix)]
mod flash;
mod guide;
mod missing_readings;
mod monitor;
mod observer;
mod output_files;
mod ports;
mod recorded_sessions;
mod recording_files;
#[cfg(unix)]
mod recording_live;
mod recordings;
mod remedies;
mod report;
mod report_numbers;
mod restarts;
mod simulate;
mod smooth;
mod streams;
mod tune;
mod tune_bias_filter;
mod tune_interrupted;
mod tune_refused;
mod version_0_1;
