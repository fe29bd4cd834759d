//! The arm's table, compiled from its TOML file when the firmware is built.
#![expect(clippy::unreadable_literal, reason = "generated code")]

include!(concat!(env!("OUT_DIR"), "/table.rs"));
