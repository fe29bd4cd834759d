//! The arm's table, compiled from its TOML file when the firmware is built.
#![expect(clippy::unreadable_literal, reason = "nobody reads the build's output")]

include!(concat!(env!("OUT_DIR"), "/table.rs"));
