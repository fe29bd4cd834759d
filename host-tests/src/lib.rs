//! Oracles for the host tests: what their results are judged against.
//!
//! [`contact`] is what touches the simulated arm, beside what the estimator says of it.
//!
//! [`faults`] are faults of sensors and recordings, to be put into the sessions of [`twin`].
//!
//! [`literal`] is the mathematics of `docs/explanation/method.md` once more, written down as it stands there and in floats: what the
//! estimator, which is streaming, decoupled and fixed point, is judged against.

pub mod contact;
pub mod faults;
pub mod literal;
pub mod parallel;
pub mod twin;
