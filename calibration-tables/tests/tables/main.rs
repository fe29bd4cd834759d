//! Arm descriptions and tables as their users write them: what is read, what is refused and how, and what is baked.

mod accepted;
mod baked;
mod common;
mod refused;
mod round_trip;
mod tuning;
