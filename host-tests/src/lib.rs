//! Oracles for the host tests: the results that they are compared with.
//!
//! [`contact`] compares the simulated arm's contacts with those that the estimator detects.
//!
//! [`faults`] are faults of sensors and recordings, to be put into the sessions of [`twin`].
//!
//! [`reference_model`] is a second implementation of the method, equation by equation and in floats. The estimator, which is
//! streaming, decoupled and fixed point, is compared with it.

pub mod contact;
pub mod faults;
pub mod parallel;
pub mod reference_model;
pub mod twin;
