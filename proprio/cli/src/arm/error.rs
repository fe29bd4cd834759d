//! Reasons why a description of a new arm cannot be made.

use board_table::{ANALOG_PINS, MAX_FULL_SCALE_PA, MAX_REGULATORS, MAX_SEGMENTS};

/// Reason why a description of a new arm cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum NewArmError {
    /// An option is missing, and standard input is no terminal to ask for it.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// Standard input cannot be read.
    #[error("{option} is missing, and the answer cannot be read: {source}")]
    Answer {
        /// The option.
        option: &'static str,
        /// Error of standard input.
        source: std::io::Error,
    },
    /// An answer, or a part of one, that is no number of the option's kind.
    #[error("{option}: {part:?} is not a number that it takes")]
    Number {
        /// The option.
        option: &'static str,
        /// The part.
        part: String,
    },
    /// More segments than the board has room for, or none.
    #[error("--lengths-mm has {0} segments, expected 1 to {MAX_SEGMENTS}")]
    Segments(usize),
    /// A length that no segment has.
    #[error("--lengths-mm: segment {segment} has {length_mm} mm, expected {:?} to {:?}", LENGTHS_MM.start(), LENGTHS_MM.end())]
    Length {
        /// Segment, from 1.
        segment: usize,
        /// Its length, mm.
        length_mm: f64,
    },
    /// Another number of segments than there are lengths.
    #[error("--bend has {found} segments, expected the {expected} of --lengths-mm")]
    BendSegments {
        /// Segments of `--bend`.
        found: usize,
        /// Segments of `--lengths-mm`.
        expected: usize,
    },
    /// More bend sensors on a segment than it can have.
    #[error("--bend: segment {segment} has {sensors} bend sensors, expected 0 to 2")]
    SegmentSensors {
        /// Segment, from 1.
        segment: usize,
        /// Its bend sensors.
        sensors: u8,
    },
    /// More bend sensors than the board has analog pins.
    #[error("--bend has {0} bend sensors in all, expected at most {ANALOG_PINS}, the board's analog pins")]
    BendSensors(usize),
    /// More regulators than the board has PWM channels.
    #[error("--regulators {0}, expected 0 to {MAX_REGULATORS}")]
    Regulators(u8),
    /// A full scale that no regulator can have.
    #[error("--full-scale-kpa {0}, expected 0.001 to {most}", most = MAX_FULL_SCALE_PA / 1000)]
    FullScale(f64),
}

/// Lengths of a segment, mm.
pub(super) const LENGTHS_MM: std::ops::RangeInclusive<f64> = 0.1..=2000.0;
