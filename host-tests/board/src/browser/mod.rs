//! The live page in a browser: `proprio monitor` on the virtual Due, and headless Chromium.

mod chromium;
mod rig;

pub use chromium::Browser;
pub use rig::MonitorRun;
