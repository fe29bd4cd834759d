//! The bias filter: drift correction by a Kalman filter over all headings, with bend sensors that may be wrong.
//!
//! Stages: trusted bend angles, plausible headings, absent headings from their neighbours, then one segment's update of
//! the [model](super::bias_state) in each sample, and the rules for rest. All limits are times, not numbers of samples.
//!
//! The bend sensors' error depends on their path (map, hysteresis) and is not white in time. Measurements are therefore
//! independent per travel, not per time: an arm at rest gives no new information about the bias.

mod correct;
mod filter;
mod headings;
mod tare;
mod tare_statistics;
mod track;
mod update;

pub use filter::BiasFilter;
pub use headings::ABSENT_TIME_S;
