//! Fixed-width forms of the messages that take most of the line's bandwidth.
//!
//! Postcard's variable-length numbers take up to three bytes for 16 bits and five for 32, too much for the line at worst.
//! Here every field has a fixed width, little-endian, and a bit mask in front marks the readings that are present. The
//! others are sent as zeros, so that all bodies of an arm have the same length and every byte has a fixed offset.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::constants::{BEND_PER_SEGMENT, MAX_SEGMENTS};

/// A [`Sample`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct SampleWire {
    pub tick: [u8; 4],
    pub time_us: [u8; 6],
    pub tare_epoch: u8,
    pub bend_read: [u8; 2],
    pub imu_read: u8,
    pub segments: Vec<SegmentSampleWire, MAX_SEGMENTS>,
}

/// One segment's bend sensors and IMU in a [`Sample`] on the line.
pub type SegmentSampleWire = ([[u8; 2]; BEND_PER_SEGMENT], [[u8; 2]; 4]);

/// An [`Estimate`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct EstimateWire {
    pub tick: [u8; 4],
    pub known: u8,
    pub segments: Vec<[[u8; 4]; 3], MAX_SEGMENTS>,
}

/// An [`Uncertainty`] on the line.
#[derive(Serialize, Deserialize, Schema)]
pub struct UncertaintyWire {
    pub tick: [u8; 4],
    pub theta_known: u8,
    pub end_known: u8,
    pub in_contact: u8,
    pub segments: Vec<(u8, [[u8; 4]; 4]), MAX_SEGMENTS>,
}
