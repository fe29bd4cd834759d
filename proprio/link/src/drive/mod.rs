//! Pressures over time, sent to a board as it wants them: again and again, as it vents when nobody does.
//!
//! | file | what it is for |
//! |---|---|
//! | `profile.rs` | what the pressures shall be |
//! | `ramp.rs` | that they change no faster than they may |
//! | `driver.rs` | arming, set-points, venting |
//! | `error.rs` | why a board is not driven |

mod driver;
mod error;
mod profile;
mod ramp;

pub use driver::{Driver, PERIOD, VALID_MS};
pub use error::DriveError;
pub use profile::Profile;
pub use ramp::Ramp;
