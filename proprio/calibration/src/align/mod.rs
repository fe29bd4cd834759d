//! Alignment of a camera's clock with that of the sensors: truth for a session without it.
//!
//! 1. Both recordings become differences between the means of two seconds and of the next two, which keep motion and remove drift
//!    and noise. An IMU's differences are those of its segment's heading; a bend sensor's follow those of the bend angle, with
//!    either sign.
//! 2. The lag to a tenth of a second is the peak of their cross-correlation.
//! 3. In windows of 20 s the lag is refined by least squares. The line through the windows' lags gives the offset and the
//!    difference of the rates, and its residuals their errors.
//! 4. The camera's poses are interpolated at the session's time stamps.
//!
//! Rigid bodies of a motion-capture program are brought to {W} by the arm's reference pose in the first second.

mod alignment;
mod angle;
mod base;
mod coarse;
mod error;
mod frames;
mod motion;
mod reference_pose;
mod truth;

use std::path::Path;

use proprio_check::clock_fit::{self, ClockFit};
use proprio_session::{BodySelection, LoadedTable, Progress};

pub use alignment::{Alignment, AlignmentReport};
pub use error::AlignmentError;
pub use proprio_check::clock_fit::ComparedSensors;
pub use truth::Written;

use crate::error::Error;
use coarse::LEAST_OVERLAP_S;
use frames::Frames;
use motion::{Readings, motion};

/// Longest recording, h: memory grows with its length, and a wrong time stamp may give any length.
const MOST_H: f64 = 24.0;
/// Largest difference of the clocks' rates: a camera of 29.97 frames per second whose times are counted as of 30.
const MOST_SKEW: f64 = 1.5e-3;

/// Finds the clocks of `camera` and of `session`, which has no truth yet. `bodies` selects those of a motion-capture program's
/// export.
///
/// # Errors
/// [`Error::File`] where one of the files cannot be used, [`Error::Alignment`] where they do not fit together.
pub fn align(
    session: &Path,
    camera: &Path,
    bodies: &BodySelection,
    arm: &LoadedTable,
    progress: &mut dyn Progress,
) -> Result<Alignment, Error> {
    let refuse = |path: &Path, source| Error::Alignment { path: path.to_owned(), source };
    let mut readings = Readings::read(session, &arm.file, progress)?;
    let frames = Frames::read(camera, bodies, &arm.file, progress)?;
    for (path, seconds) in [(session, readings.seconds()), (camera, frames.seconds())] {
        check_length(seconds).map_err(|source| refuse(path, source))?;
    }
    let motion = motion(&mut readings, &frames).map_err(|source| refuse(session, source))?;
    let fit = coarse::lag_s(&motion).and_then(|lag_s| clock_fit::fit(&motion, lag_s).ok_or(AlignmentError::Still));
    let fit = fit.and_then(|fit| check(motion.by, fit)).map_err(|source| refuse(camera, source))?;

    let start_s = readings.first_us() as f64 / 1e6;
    let report = AlignmentReport {
        sensors: motion.by,
        offset_s: frames.first_s - start_s + fit.clocks.camera_s(fit.middle_s) - fit.middle_s,
        offset_error_ms: fit.lag_error_s * 1e3,
        middle_s: start_s + fit.middle_s,
        skew_ppm: fit.clocks.skew * 1e6,
        skew_error_ppm: fit.skew_error * 1e6,
        residual_ms: fit.residual_s * 1e3,
        correlation: fit.correlation,
        matched: fit.matched,
    };
    let defects = [readings.defects.clone(), frames.defects.clone()];
    Ok(Alignment { frames, readings, clocks: fit.clocks, defects, report })
}

fn check_length(seconds: f64) -> Result<(), AlignmentError> {
    let hours = seconds / 3600.0;
    if seconds < LEAST_OVERLAP_S {
        Err(AlignmentError::TooShort { seconds, least_s: LEAST_OVERLAP_S })
    } else if hours > MOST_H {
        Err(AlignmentError::TooLong { hours, most_h: MOST_H })
    } else {
        Ok(())
    }
}

/// Checks that a fit is good enough.
fn check(by: ComparedSensors, fit: ClockFit) -> Result<ClockFit, AlignmentError> {
    let (correlation, least) = (fit.correlation, by.least_correlation());
    if correlation < least {
        return Err(AlignmentError::Unrelated { correlation, least });
    }
    if fit.residual_s > by.most_residual_s() {
        let (residual_ms, most_ms) = (fit.residual_s * 1e3, by.most_residual_s() * 1e3);
        return Err(AlignmentError::Uneven { residual_ms, most_ms });
    }
    // Short recordings of bend sensors determine the rates poorly.
    if fit.clocks.skew.abs() - 3.0 * fit.skew_error > MOST_SKEW {
        return Err(AlignmentError::Skewed { ppm: fit.clocks.skew * 1e6, most_ppm: MOST_SKEW * 1e6 });
    }
    Ok(fit)
}
