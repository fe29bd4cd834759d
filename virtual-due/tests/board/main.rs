//! The emulated board with firmware on it, and the command that runs it.

mod command;
mod gdb;
mod machine;
mod pins;
mod program;
mod sketches;
