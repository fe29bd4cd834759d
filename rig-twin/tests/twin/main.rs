//! What the twin promises to those who build on it: the same bits, a believable arm, sensors with the paper's flaws.

mod calibration;
mod camera;
mod determinism;
mod family;
mod kinematics;
mod motion;
mod programs;
mod recording;
mod robustness;
mod sensors;
