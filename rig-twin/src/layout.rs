//! Layout of an arm: its segments, their lengths, and the sensors on them.

use crate::constants::{
    CONNECTOR_LENGTH_M, CURVE_LENGTH_M, MAX_MODULES, MAX_REGULATORS, MAX_SEGMENTS, SEGMENTS, SEGMENTS_PER_MODULE,
    SENSORS_PER_SEGMENT,
};

/// One value for each segment, from the base.
pub type PerSegment<T> = heapless::Vec<T, MAX_SEGMENTS>;
/// One value for each place of a bend sensor: 1a, 1b, 2a, … Every segment has two places, with or without a sensor.
pub type PerBendSensor<T> = heapless::Vec<T, { SENSORS_PER_SEGMENT * MAX_SEGMENTS }>;
/// One value for each module, from the base.
pub(crate) type PerModule<T> = heapless::Vec<T, MAX_MODULES>;
/// One value for each regulator: module 1 right, left, module 2 right, left, …
pub type PerRegulator<T> = heapless::Vec<T, MAX_REGULATORS>;

/// Nominal geometry of a segment, and its sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentLayout {
    /// Arc length of the curved part, m. Strips scale with it.
    pub curve_m: f64,
    /// Length of the rigid connector, m.
    pub connector_m: f64,
    /// True if the connector precedes the curved part.
    pub connector_first: bool,
    /// True for each of the bend sensors a and b that the segment has.
    pub bend: [bool; SENSORS_PER_SEGMENT],
    /// True if an IMU is at the segment's end.
    pub imu: bool,
}

/// Layout of an arm of 1 to 8 segments.
///
/// Two segments are a module, which one regulator bends to the right and one to the left. The last segment of an arm
/// with an odd number of segments is a module of its own.
///
/// ```
/// use rig_twin::{Layout, LayoutError, MAX_SEGMENTS};
///
/// let three = Layout::uniform(3)?;
/// assert_eq!((three.segments().len(), three.modules(), three.regulators()), (3, 2, 4));
/// assert_eq!(Layout::uniform(MAX_SEGMENTS + 1), Err(LayoutError::Segments(9)));
/// # Ok::<(), LayoutError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    segments: PerSegment<SegmentLayout>,
}

/// A layout that the twin cannot simulate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LayoutError {
    /// A number of segments out of range.
    #[error("{0} segments, expected 1 to {MAX_SEGMENTS}")]
    Segments(usize),
    /// A length that is not positive, or a connector of negative length; the segment is counted from 0.
    #[error("segment {}: a curve of {curve_m} m and a connector of {connector_m} m", segment + 1)]
    Length {
        /// The segment.
        segment: usize,
        /// Its curve's length.
        curve_m: f64,
        /// Its connector's length.
        connector_m: f64,
    },
}

impl Layout {
    /// A layout of these segments, from the base.
    ///
    /// # Errors
    /// [`LayoutError`].
    pub fn new(segments: &[SegmentLayout]) -> Result<Self, LayoutError> {
        if !(1..=MAX_SEGMENTS).contains(&segments.len()) {
            return Err(LayoutError::Segments(segments.len()));
        }
        for (segment, &SegmentLayout { curve_m, connector_m, .. }) in segments.iter().enumerate() {
            let is_valid = curve_m > 0.0 && connector_m >= 0.0 && (curve_m + connector_m).is_finite();
            if !is_valid {
                return Err(LayoutError::Length { segment, curve_m, connector_m });
            }
        }
        Ok(Self { segments: segments.iter().copied().collect() })
    }

    /// A layout of `count` segments like the reference arm's, each with two bend sensors and an IMU.
    ///
    /// # Errors
    /// [`LayoutError::Segments`].
    pub fn uniform(count: usize) -> Result<Self, LayoutError> {
        if !(1..=MAX_SEGMENTS).contains(&count) {
            return Err(LayoutError::Segments(count));
        }
        Ok(Self { segments: (0..count).map(reference_segment).collect() })
    }

    /// The segments, from the base.
    pub fn segments(&self) -> &[SegmentLayout] {
        &self.segments
    }

    /// Number of modules.
    pub fn modules(&self) -> usize {
        self.segments.len().div_ceil(SEGMENTS_PER_MODULE)
    }

    /// Number of regulators: two for each module.
    pub fn regulators(&self) -> usize {
        2 * self.modules()
    }

    /// Index of each place of a bend sensor, and true if a sensor is there.
    pub(crate) fn bend_sensors(&self) -> impl Iterator<Item = (usize, bool)> {
        self.segments.iter().flat_map(|segment| segment.bend).enumerate()
    }

    /// Share of a full module that module `module`, counted from 0, has of its segments: 1, or a half.
    pub(crate) fn share_of_module(&self, module: usize) -> f64 {
        let segments = self.segments.len().saturating_sub(SEGMENTS_PER_MODULE * module).min(SEGMENTS_PER_MODULE);
        segments as f64 / SEGMENTS_PER_MODULE as f64
    }
}

impl Default for Layout {
    /// The reference arm's.
    fn default() -> Self {
        Self { segments: (0..SEGMENTS).map(reference_segment).collect() }
    }
}

/// Segment `segment`, counted from 0, of the reference arm: connectors of two neighbours meet inside a module.
fn reference_segment(segment: usize) -> SegmentLayout {
    SegmentLayout {
        curve_m: CURVE_LENGTH_M,
        connector_m: CONNECTOR_LENGTH_M,
        connector_first: segment % 2 == 1,
        bend: [true; SENSORS_PER_SEGMENT],
        imu: true,
    }
}
