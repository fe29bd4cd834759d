//! Fusion: KF_orient and KF_coord.

pub mod kalman;
