//! Oracles for the host tests.
//!
//! [`literal`] is the mathematics of `docs/METHOD.md` once more, written down as it stands there and in floats: what the
//! estimator, which is streaming, decoupled and fixed point, is judged against.

pub mod literal;
