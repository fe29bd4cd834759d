//! The link to a board, over a line in memory: noise, losses, restarts, requests, and cables that come and go.

mod line;
mod mismatches;
mod noise;
mod reconnect;
mod requests;
