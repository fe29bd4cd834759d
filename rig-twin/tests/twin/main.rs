//! Properties of the twin that other crates rely on: the same bits, a plausible arm, sensors with the paper's flaws.

mod calibration;
mod camera;
mod determinism;
mod family;
mod faults;
mod kinematics;
mod layouts;
mod motion;
mod programs;
mod recording;
mod robustness;
mod sensors;
