//! Errors of the alignment of a camera's file and a session.

/// An error that prevents an alignment.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AlignmentError {
    /// The session has no reading to compare.
    #[error("has no reading of any IMU or bend sensor")]
    NoSensors,
    /// The camera saw no marker.
    #[error("the camera saw no marker of a segment")]
    NoMarkers,
    /// There are columns of the base's marker without a pose in them.
    #[error("the camera never saw the base's marker")]
    NoBase,
    /// The base's marker was not at rest.
    #[error("the base's marker moved by {mm:.0} mm and {deg:.1}° during the recording")]
    BaseMoved {
        /// Distance of the motion, mm.
        mm: f64,
        /// Angle of the motion, degrees.
        deg: f64,
    },
    /// A body of a motion-capture program's export was not seen at rest.
    #[error("{} was not seen in the first second", body_name(*body))]
    NotSeenAtRest {
        /// The segment at whose end it is, from 1; 0 for the base.
        body: usize,
    },
    /// A body of a motion-capture program's export moved in the first second.
    #[error("{} moved by {mm:.0} mm and {deg:.1}° in the first second, in which the arm rests", body_name(*body))]
    MovedAtRest {
        /// The segment at whose end it is, from 1; 0 for the base.
        body: usize,
        /// Distance of the motion, mm.
        mm: f64,
        /// Angle of the motion, degrees.
        deg: f64,
    },
    /// The bodies of a motion-capture program's export are not where the reference pose has them.
    #[error(
        "in the first second the bodies are {misfit_mm:.0} mm RMS off the reference pose, expected at most {most_mm:.0}"
    )]
    NotInReferencePose {
        /// Root mean square of the distances, mm.
        misfit_mm: f64,
        /// Allowed value, mm.
        most_mm: f64,
    },
    /// A recording is too short.
    #[error("the recording lasts {seconds:.1} s, expected at least {least_s} s")]
    TooShort {
        /// Its length, s.
        seconds: f64,
        /// Length needed, s.
        least_s: f64,
    },
    /// A recording is too long, or seems to be.
    #[error("the recording lasts {hours:.0} h by its time stamps, expected at most {most_h}")]
    TooLong {
        /// Its length, h.
        hours: f64,
        /// Allowed length, h.
        most_h: f64,
    },
    /// No offset brings the motions together.
    #[error("has no motion in common with the session: the best correlation is {correlation:.2}, expected {least}")]
    Unrelated {
        /// Correlation at the best offset.
        correlation: f64,
        /// Correlation needed.
        least: f64,
    },
    /// The camera's headings run the wrong way.
    #[error("the camera's headings fall where the IMUs' rise: their correlation is {correlation:.2}")]
    Mirrored {
        /// Correlation at the best offset.
        correlation: f64,
    },
    /// Several offsets bring the motions together.
    #[error(
        "two offsets, {apart_s:.1} s apart, fit nearly alike, with correlations of {:.2} and {:.2}",
        correlations[0], correlations[1]
    )]
    Ambiguous {
        /// Time between them, s.
        apart_s: f64,
        /// Their correlations.
        correlations: [f64; 2],
    },
    /// The overlap without pauses is too short.
    #[error("shares less than {least_s} s with the session at any offset, pauses of markers and sensors left out")]
    Hidden {
        /// Shortest overlap, s.
        least_s: f64,
    },
    /// The arm rests nearly all the time.
    #[error("the arm hardly moves where both saw it without a pause")]
    Still,
    /// The clocks run too differently.
    #[error("the clocks' rates differ by {ppm:.0} ppm, expected at most {most_ppm}")]
    Skewed {
        /// Found difference, ppm.
        ppm: f64,
        /// Allowed difference, ppm.
        most_ppm: f64,
    },
    /// One of the clocks jumps or wanders.
    #[error(
        "the clocks do not run evenly: pieces of the recording are {residual_ms:.0} ms RMS off, expected at most {most_ms}"
    )]
    Uneven {
        /// Root mean square of the residual lags after a steady rate, ms.
        residual_ms: f64,
        /// Allowed value, ms.
        most_ms: f64,
    },
}

/// The body at a segment's end, or the base's.
fn body_name(body: usize) -> String {
    if body == 0 { "the base's body".to_owned() } else { format!("the body of segment {body}") }
}
