//! The TOML file as it stands, read and written without loss.

use std::io::Read;
use std::path::Path;

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize};
use toml_edit::Item;

use crate::bend::{BendErrorKeys, CurveKeys, MemoryKeys};
use crate::contact::{ChangeKeys, ContactKeys, CoupledKeys};
use crate::drift::{DriftKeys, DriftKind};
use crate::place::{line_and_column, line_of};
use crate::tuning::TuningKeys;
use crate::uncertainty::UncertaintyKeys;

/// The `format` that this crate reads and writes.
const FORMAT: u32 = 1;
/// Size of the largest file.
const MAX_BYTES: u64 = 1 << 20;
/// Segments of the longest arm.
pub const MAX_SEGMENTS: usize = 16;
/// Values of the longest anchor window.
pub const MAX_WINDOW: u16 = 1000;

/// An arm description or a table. Key names and meanings are those of the file; angles in degrees, lengths in mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmFile {
    /// Format number, 1.
    pub format: u32,
    /// Name of the arm.
    pub arm: String,
    /// Sample rate of the sessions that the arm usually records; a session's own time stamps come first.
    pub rate_hz: f64,
    /// How headings get their zero.
    #[serde(default)]
    pub tare: TareKeys,
    /// The drift anchor.
    #[serde(default)]
    pub anchor: AnchorKeys,
    /// Drift correction of the IMUs; `None`: the anchor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftKeys>,
    /// Contact-detection thresholds; `None` disables detection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactKeys>,
    /// Error sources of the estimates; `None`: no covariance is computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<UncertaintyKeys>,
    /// How the filters were tuned, where they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tuning: Option<TuningKeys>,
    /// The segments from the base to the tip.
    #[serde(rename = "segment")]
    pub segments: Vec<SegmentKeys>,
}

/// `[tare]`: the arm rests in its reference pose for the first `seconds`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TareKeys {
    /// Duration; 0 where headings are absolute already.
    pub seconds: f64,
    /// Heading of each segment's end in the reference pose; none: straight.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub heading_deg: Vec<f64>,
}

impl Default for TareKeys {
    fn default() -> Self {
        Self { seconds: 1.0, heading_deg: Vec::new() }
    }
}

/// `[anchor]`: the paper's moving average.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AnchorKeys {
    /// Values in the window.
    pub window: u16,
    /// Offsets up to this size are left alone.
    pub threshold_deg: f64,
    /// Rate of the window's values; a faster session is averaged down to it.
    pub rate_hz: f64,
}

impl Default for AnchorKeys {
    fn default() -> Self {
        Self { window: 100, threshold_deg: 0.5, rate_hz: 10.0 }
    }
}

/// `[[segment]]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentKeys {
    /// Arc length of the curved part.
    pub length_mm: f64,
    /// Length of the rigid connector.
    pub offset_mm: f64,
    /// Side of the connector.
    pub offset_at: Side,
    /// The bend sensors a and b, as many as there are; `None` in an arm description.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend: Option<Vec<BendKeys>>,
    /// Hysteresis compensation of their mean, up to three plays.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hysteresis: Vec<PlayKeys>,
    /// Errors of the bend sensors, from the calibration sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend_error: Option<BendErrorKeys>,
    /// Sensitivity of the IMU's heading: what it reads of a turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imu_scale: Option<f64>,
    /// The earlier segment that bends alike, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "alike")]
    pub coupled_to: Option<CoupledKeys>,
    /// Limits of contact detection by the bend sensors; those of `coupled_to` are there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ChangeKeys>,
    /// KF_orient's parameters, rad² and rad²/s; derived from the maps' `rmse_deg` where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orient: Option<NoiseKeys>,
    /// KF_coord's parameters, m² and m²/s; derived as `orient` where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coord: Option<NoiseKeys>,
}

/// `offset_at`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The connector precedes the curved part.
    Start,
    /// The connector follows the curved part.
    End,
}

/// One bend sensor's V–Orient map, θ = c2 V² + c1 V + c0 in rad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BendKeys {
    /// rad.
    pub c0: f64,
    /// rad/V.
    pub c1: f64,
    /// rad/V².
    pub c2: f64,
    /// Residual of the calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_deg: Option<f64>,
    /// Lowest and highest voltage of the calibration, V; where it is not known, those of half a turn.
    #[serde(default, deserialize_with = "pair", skip_serializing_if = "Option::is_none")]
    pub volts: Option<[f64; 2]>,
    /// A curve that takes the quadratic's place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveKeys>,
    /// Creep and hysteresis of this sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<MemoryKeys>,
}

/// One play of a segment's hysteresis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlayKeys {
    /// Radius: from its middle to either edge.
    #[serde(alias = "half_width_deg")]
    pub radius_deg: f64,
    /// Of the difference of the bend angle and the play, in the correction.
    pub weight: f64,
}

/// Parameters of one block of KF_orient (rad) or KF_coord (m).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseKeys {
    /// Process noise per second.
    pub q: f64,
    /// Variance of the drift-corrected IMU's measurement.
    pub r_imu: f64,
    /// Variance of the bend sensors' measurement.
    pub r_bend: f64,
    /// H of the drift-corrected IMU.
    #[serde(default = "one")]
    pub h_imu: f64,
    /// H of the bend sensors.
    #[serde(default = "one")]
    pub h_bend: f64,
}

fn one() -> f64 {
    1.0
}

/// Why a file is no arm description or table.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is larger than any table.
    #[error("is larger than {MAX_BYTES} bytes, which no arm description or table is")]
    Size,
    /// It is not TOML, or a key is missing, unknown or of the wrong type.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// The format number is from another time.
    #[error("format = {0} is not known; this version reads format = {FORMAT}")]
    Format(u32),
    /// A value that the estimator cannot use.
    #[error("{}{key} = {found}, expected {expected}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Value {
        /// Line, from 1, where the key is in the file.
        line: Option<usize>,
        /// Where, such as `segment[2].bend[1].volts`, counted from 1.
        key: String,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// A description where a table is needed.
    #[error("segment[{0}] says nothing of its bend sensors: this is an arm description, not a table")]
    NotCalibrated(usize),
}

impl FileError {
    /// What to do about it.
    #[must_use]
    pub const fn remedy(&self) -> &'static str {
        match self {
            Self::Read(_) => "check the name and that you may read it; it must be a text file in UTF-8",
            Self::Size => "name the .toml file of the arm",
            Self::Syntax { .. } => "correct the line; the keys are listed in docs/reference/table.md",
            Self::Format(_) => "take a version of proprio that knows this format",
            Self::Value { .. } => "correct the value, or make the table again with `proprio calibrate`",
            Self::NotCalibrated(_) => "make a table of it with `proprio calibrate`, or write bend = [] if it has none",
        }
    }
}

impl ArmFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Any [`FileError`] but [`FileError::NotCalibrated`].
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let mut text = String::new();
        std::fs::File::open(path)?.take(MAX_BYTES + 1).read_to_string(&mut text)?;
        if text.len() as u64 > MAX_BYTES { Err(FileError::Size) } else { Self::parse(&text) }
    }

    /// Checks a file's text; a byte-order mark is accepted.
    ///
    /// # Errors
    /// As [`ArmFile::load`].
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let text = text.trim_start_matches('\u{feff}');
        let version: Version = read(text)?;
        if version.format != FORMAT {
            return Err(FileError::Format(version.format));
        }
        let file: Self = read(text)?;
        file.check().map_err(|error| match error {
            FileError::Value { key, found, expected, .. } => {
                FileError::Value { line: line_of(text, &key), key, found, expected }
            }
            other => other,
        })?;
        Ok(file)
    }

    /// The file's text, from which [`ArmFile::parse`] gets the same values back to the last bit.
    ///
    /// # Panics
    /// Never: every value of the format has a form in TOML.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut document = toml_edit::ser::to_document(self).expect("every value of the format has a form in TOML");
        // Tables of their own for the outermost keys, one line each for sensors and filters within.
        for (_, item) in document.iter_mut() {
            *item = match std::mem::take(item).into_array_of_tables() {
                Ok(tables) => Item::ArrayOfTables(tables),
                Err(other) => other.into_table().map_or_else(std::convert::identity, Item::Table),
            };
        }
        document.to_string()
    }

    /// The bias filter, if that corrects the drift.
    #[must_use]
    pub fn bias_filter(&self) -> Option<&DriftKeys> {
        self.drift.as_ref().filter(|drift| drift.kind != DriftKind::Anchor)
    }

    /// Length of the straight arm, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length_mm + segment.offset_mm).sum()
    }

    /// Number of bend sensors on each segment.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn bend_sensors(&self) -> Result<Vec<usize>, FileError> {
        let sensors = |(i, segment): (usize, &SegmentKeys)| {
            segment.bend.as_ref().map(Vec::len).ok_or(FileError::NotCalibrated(i + 1))
        };
        self.segments.iter().enumerate().map(sensors).collect()
    }
}

fn read<T: DeserializeOwned>(text: &str) -> Result<T, FileError> {
    toml_edit::de::from_str(text).map_err(|error| {
        let (line, column) = line_and_column(text, error.span().map_or(0, |span| span.start));
        let message = error.message().chars().take(200).collect::<String>().replace('\n', ", ");
        FileError::Syntax { line, column, message }
    })
}

/// An array of two numbers, no more.
pub(crate) fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    let numbers = Vec::deserialize(deserializer)?;
    let found = numbers.len();
    let pair = numbers.try_into().map_err(|_: Vec<f64>| D::Error::custom(format!("{found} numbers, expected 2")))?;
    Ok(Some(pair))
}

/// The format number alone, so that a file of another format is told so and not that its keys are unknown.
#[derive(Deserialize)]
struct Version {
    format: u32,
}
