//! Sensing: readings to bend angles and headings.

pub mod bend_map;
pub mod bend_sensors;
pub mod heading;
pub mod hysteresis;
