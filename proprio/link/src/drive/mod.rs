//! Pressures over time. They are sent to the board every 50 ms, as it vents when they are not renewed.
//!
//! | file | purpose |
//! |---|---|
//! | `profile.rs` | pressures over time |
//! | `ramp.rs` | limit of their rate of change |
//! | `driver.rs` | arming, set-points, venting |
//! | `error.rs` | errors that end driving |

mod driver;
mod error;
mod profile;
mod ramp;

pub use driver::{Driver, PERIOD, VALID_MS};
pub use error::DriveError;
pub use profile::Profile;
pub use ramp::Ramp;
