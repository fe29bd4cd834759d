//! An arm's table as the estimator uses it: in its own number type, and baked for one sample rate.

use crate::anchor::AnchorRule;
use crate::angle::Turns;
use crate::bend::BendMap;
use crate::contact::{Alike, ContactRule};
use crate::filter::Noise;
use crate::hysteresis::Hysteresis;
use crate::observer::ObserverRule;
use crate::sample::SENSORS_PER_SEGMENT;
use crate::scalar::Scalar;
use crate::uncertainty::UncertaintyRule;

/// Where a segment's rigid connector sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffsetAt {
    /// It precedes the curved part.
    Start,
    /// It follows the curved part.
    End,
}

/// One sensing segment: geometry, maps and filter parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment<S> {
    /// Arc length of the curved part, L_act, m.
    pub length: S,
    /// Length of the rigid connector, d_off, m.
    pub offset: S,
    /// Side of the connector.
    pub offset_at: OffsetAt,
    /// V–Orient maps of the bend sensors a and b, where the segment has them.
    pub bend: [Option<BendMap<S>>; SENSORS_PER_SEGMENT],
    /// What corrects their angle for the way that they came, where anything does.
    pub hysteresis: Option<Hysteresis<S>>,
    /// The earlier segment that bends alike, where there is one.
    pub alike: Option<Alike>,
    /// Heading of the segment's end in the reference pose.
    pub reference: Turns,
    /// KF_orient's parameters.
    pub orient: Noise<S>,
    /// KF_coord's parameters.
    pub coord: Noise<S>,
}

impl<S: Scalar> Segment<S> {
    /// A segment without bend sensors: `length` and `offset` in m, connector at the end, straight at rest.
    #[must_use]
    pub fn bare(length: f64, offset: f64) -> Self {
        let noise = Noise { q: S::one(), r_imu: S::one(), r_bend: S::one(), h_imu: S::one(), h_bend: S::one() };
        Self {
            length: S::from_f64(length),
            offset: S::from_f64(offset),
            offset_at: OffsetAt::End,
            bend: [None; SENSORS_PER_SEGMENT],
            hysteresis: None,
            alike: None,
            reference: Turns::ZERO,
            orient: noise,
            coord: noise,
        }
    }
}

/// An arm's calibration. The firmware holds one as a constant; on the host `calibration-tables` bakes it from TOML.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Table<'t, S> {
    /// The segments from the base to the tip.
    pub segments: &'t [Segment<S>],
    /// Samples at the start over which headings are tared; 0: they are absolute.
    pub tare_samples: u32,
    /// The drift anchor's parameters; its rate is the observer's, too.
    pub anchor: AnchorRule,
    /// How drift is observed; `None`: the paper's anchor corrects it.
    pub observer: Option<ObserverRule>,
    /// What contact is told by; `None`: nobody looks.
    pub contact: Option<ContactRule>,
    /// What the estimates' variances are made of; `None`: there are none.
    pub uncertainty: Option<UncertaintyRule<S>>,
}

impl<S> Table<'_, S> {
    /// Whether it asks for more than the paper's method.
    pub(crate) fn is_beyond_the_paper(&self) -> bool {
        let Self { segments, observer, contact, uncertainty, .. } = self;
        let corrects_hysteresis = segments.iter().any(|segment| segment.hysteresis.is_some());
        observer.is_some() || contact.is_some() || uncertainty.is_some() || corrects_hysteresis
    }
}

impl<'t, S> Table<'t, S> {
    /// A table with absolute headings and the paper's anchor at 10 Hz: 10 s, 0.5°.
    #[must_use]
    pub const fn bare(segments: &'t [Segment<S>]) -> Self {
        // 0.5° in units of 2⁻³² turns.
        let anchor = AnchorRule {
            window: 100,
            rate_millihertz: 10_000,
            sample_rate_millihertz: 10_000,
            threshold: Turns::from_bits(5_965_232),
        };
        Self { segments, tare_samples: 0, anchor, observer: None, contact: None, uncertainty: None }
    }
}

/// Why an [`Estimator`](crate::Estimator) cannot use a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableError {
    /// The table has no segment, or more than the estimator was built for.
    Segments {
        /// Segments of the table.
        found: usize,
        /// Segments that the estimator has room for.
        room: usize,
    },
    /// The anchor's window is empty, or longer than the estimator was built for.
    Window {
        /// Length of the table's window.
        found: u16,
        /// Length that the estimator has room for.
        room: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Segments { found, room } => write!(f, "the table has {found} segments, expected 1 to {room}"),
            Self::Window { found, room } => write!(f, "the anchor's window is {found} values, expected 1 to {room}"),
        }
    }
}

impl core::error::Error for TableError {}
