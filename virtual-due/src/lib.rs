//! An emulated Arduino Due.

pub mod model;
mod report;

pub use report::Report;
