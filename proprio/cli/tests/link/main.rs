//! The link to a board, over a line in memory: noise, losses, restarts, requests, and cables that come and go; and the
//! live page of it.

mod access;
mod any_arm;
mod findings;
mod flashed;
mod http;
mod late_recordings;
mod line;
mod mismatches;
mod monitored_line;
mod noise;
mod older;
mod page;
mod reconnect;
mod requests;
mod running;
mod sessions;
mod stream;
mod tare;
mod uncertainty;
