//! An arm description or a table: the keys of the TOML file.

use board_table::{MAX_SEGMENTS as MAX_BOARD_SEGMENTS, Wiring};
use serde::{Deserialize, Serialize};

use crate::board::BoardToml;
use crate::calibration::CalibrationToml;
use crate::contact::ContactToml;
use crate::drift::{DriftKind, DriftToml};
use crate::error::{FileError, ensure, within};
use crate::segment::{MAX_ARM_MM, SegmentToml};
use crate::tuning::TuningToml;
use crate::uncertainty::UncertaintyToml;

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
    /// Default sample rate of the arm's sessions; a session's own time stamps take precedence.
    pub rate_hz: f64,
    /// Tare of the headings.
    #[serde(default)]
    pub tare: TareToml,
    /// The drift anchor.
    #[serde(default)]
    pub anchor: AnchorToml,
    /// Drift correction of the IMUs; `None`: the anchor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftToml>,
    /// Contact-detection thresholds; `None` disables detection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactToml>,
    /// Error sources of the estimates; `None`: no covariance is computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<UncertaintyToml>,
    /// Record of the calibration, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationToml>,
    /// Record of the tuning, if the filters were tuned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tuning: Option<TuningToml>,
    /// Wiring to the board; `None`: the reference wiring of docs/how-to/wiring.md. Before the segments in
    /// the file, so that one cut short has fewer segments than pins and is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub board: Option<BoardToml>,
    /// The segments from the base to the tip.
    #[serde(rename = "segment")]
    pub segments: Vec<SegmentToml>,
}

/// `[tare]`: the arm rests in its reference pose for the first `seconds`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TareToml {
    /// Duration; 0 if headings are absolute already.
    pub seconds: f64,
    /// Heading of each segment's end in the reference pose; empty: straight.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub heading_deg: Vec<f64>,
}

impl Default for TareToml {
    fn default() -> Self {
        Self { seconds: 1.0, heading_deg: Vec::new() }
    }
}

/// `[anchor]`: the paper's moving average.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AnchorToml {
    /// Values in the window.
    pub window: u16,
    /// Offsets up to this size are not applied.
    pub threshold_deg: f64,
    /// Rate of the window's values; a faster session is averaged down to it.
    pub rate_hz: f64,
}

impl Default for AnchorToml {
    fn default() -> Self {
        Self { window: 100, threshold_deg: 0.5, rate_hz: 10.0 }
    }
}

impl ArmFile {
    /// The bias filter, if that corrects the drift.
    #[must_use]
    pub fn bias_filter(&self) -> Option<&DriftToml> {
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
        let sensors = |(i, segment): (usize, &SegmentToml)| {
            segment.bend.as_ref().map(Vec::len).ok_or(FileError::NotCalibrated(i + 1))
        };
        self.segments.iter().enumerate().map(sensors).collect()
    }

    /// The wiring to the board: that of the section `[board]`, or else the reference wiring. `None` for more segments than the
    /// board has room for.
    #[must_use]
    pub fn wiring(&self) -> Option<Wiring> {
        let n = self.segments.len();
        self.board.as_ref().map_or_else(|| (n <= MAX_BOARD_SEGMENTS).then(|| Wiring::reference(n)), BoardToml::wiring)
    }

    /// Returns whether it is an arm description: no segment has an entry `bend`, nor has any been calibrated.
    #[must_use]
    pub fn is_description(&self) -> bool {
        self.segments.iter().all(|segment| segment.bend.is_none())
    }

    /// A table of the arm by its IMUs alone, for a board that is to record the arm's first sweep.
    #[must_use]
    pub fn without_bend_maps(&self) -> Self {
        let segments = self.segments.iter().map(|segment| SegmentToml { bend: Some(Vec::new()), ..segment.clone() });
        Self { segments: segments.collect(), ..self.clone() }
    }

    pub(crate) fn check(&self) -> Result<(), FileError> {
        let n = self.segments.len();
        ensure((1..=MAX_SEGMENTS).contains(&n), "segment", &n, &format!("1 to {MAX_SEGMENTS} segments"))?;
        within("rate_hz", self.rate_hz, 0.01..=10_000.0)?;
        within("tare.seconds", self.tare.seconds, 0.0..=3600.0)?;
        let headings = self.tare.heading_deg.len();
        ensure([0, n].contains(&headings), "tare.heading_deg", &headings, &format!("{n} headings, one per segment"))?;
        for (i, heading) in self.tare.heading_deg.iter().enumerate() {
            within(&format!("tare.heading_deg[{}]", i + 1), *heading, -3600.0..=3600.0)?;
        }
        let window = self.anchor.window;
        ensure((1..=MAX_WINDOW).contains(&window), "anchor.window", &window, &format!("1 to {MAX_WINDOW} values"))?;
        within("anchor.threshold_deg", self.anchor.threshold_deg, 0.0..=360.0)?;
        within("anchor.rate_hz", self.anchor.rate_hz, 0.01..=10_000.0)?;
        self.drift.as_ref().map_or(Ok(()), DriftToml::check)?;
        self.contact.as_ref().map_or(Ok(()), ContactToml::check)?;
        self.uncertainty.as_ref().map_or(Ok(()), UncertaintyToml::check)?;
        self.calibration.as_ref().map_or(Ok(()), CalibrationToml::check)?;
        self.tuning.as_ref().map_or(Ok(()), TuningToml::check)?;
        for (i, segment) in self.segments.iter().enumerate() {
            segment.check(&format!("segment[{}]", i + 1))?;
            segment
                .coupled_to
                .map_or(Ok(()), |coupled| coupled.check(&format!("segment[{}].coupled_to", i + 1), i + 1))?;
            segment.contact.map_or(Ok(()), |limit| limit.check(&format!("segment[{}].contact", i + 1)))?;
        }
        self.board.as_ref().map_or(Ok(()), |board| board.check(&self.segments))?;
        let length = self.length_mm();
        ensure(length <= MAX_ARM_MM, "segment", &format!("{length} mm of arm"), &format!("at most {MAX_ARM_MM} mm"))
    }
}
