//! The emulated board with firmware on it, and the command that runs it.

mod command;
mod machine;
mod program;
mod sketches;
