//! The serial protocol between the arm's board and a host.
#![no_std]

mod message;

pub use message::*;
