//! Fixed-width forms of the messages that take most of the line's bandwidth.
//!
//! Postcard's variable-length numbers take up to three bytes for 16 bits and five for 32, too much for the line at worst.
//! Here every field has a fixed width, little-endian, and a bit mask in front marks the readings that are present. The
//! others are sent as zeros, so that a body always has the same length and every byte a fixed offset.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::constants::{BEND_SENSORS, SEGMENTS};

/// A [`Sample`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct SampleWire {
    pub tick: [u8; 4],
    pub time_us: [u8; 8],
    pub tare_epoch: u8,
    pub bend_read: [u8; 2],
    pub imu_read: u8,
    pub bend: [[u8; 2]; BEND_SENSORS],
    pub imu: [[[u8; 2]; 4]; SEGMENTS],
}

/// An [`Estimate`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct EstimateWire {
    pub tick: [u8; 4],
    pub known: u8,
    pub segments: [[[u8; 4]; 3]; SEGMENTS],
}

/// An [`Uncertainty`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct UncertaintyWire {
    pub tick: [u8; 4],
    pub theta_known: u8,
    pub end_known: u8,
    pub in_contact: u8,
    pub segments: [(u8, [[u8; 4]; 4]); SEGMENTS],
}
