//! Arm descriptions and tables as users write them: accepted and rejected files, and their compilation.

mod accepted;
mod board;
mod common;
mod compiled;
mod refused;
mod round_trip;
mod tuning;
