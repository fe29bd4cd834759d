//! Numbers: the scalar that the pipeline is generic over, its fixed-point form, and angles as whole numbers.

pub mod angle;
pub mod division;
pub mod fused;
pub mod phase;
pub mod polynomial;
pub mod q;
mod q_fused;
mod q_scalar;
pub mod saturation;
pub mod scalar;
pub mod variance;
