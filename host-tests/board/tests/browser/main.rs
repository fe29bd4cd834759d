//! The live page in a browser: `proprio monitor` on the virtual Due, and headless Chromium.
//!
//! These tests are ignored by `cargo test`, as they need Chromium; `.ci/browser` runs them. Pictures of the page are left in
//! `target/browser`.
#![cfg(unix)]

mod accessibility;
mod first;
mod live;
mod modules;
mod page;
mod pictures;
mod sessions;
mod slow;
mod sweep;
mod values;
