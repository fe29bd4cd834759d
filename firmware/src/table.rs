//! The arm's table, baked from its TOML file when the firmware is built.

include!(concat!(env!("OUT_DIR"), "/table.rs"));
