//! Heading of one IMU: from its quaternion, unwrapped from reading to reading, and tared in the reference pose.

use crate::kinematics::pcc::sin_cos;
use crate::numeric::angle::Angle;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::{Phase, Turns};
use crate::types::ImuReading;

impl ImuReading {
    /// The heading, clockwise positive seen from above: h = −atan2(2(wz + xy), 1 − 2(y² + z²)).
    ///
    /// `None` for an invalid orientation: a quaternion whose norm deviates from 1 by over 1 % (all zero after a
    /// brown-out, for example), or a sensor whose x axis points straight up or down.
    ///
    /// ```
    /// use estimator_core::ImuReading;
    ///
    /// // 90° counter-clockwise about z.
    /// let heading = ImuReading::from_bno055([11585, 0, 0, 11585]).heading().expect("a unit quaternion");
    /// assert!((heading.rad().to_degrees() + 90.0).abs() < 0.01);
    /// assert_eq!(ImuReading::from_bno055([0, 0, 0, 0]).heading(), None);
    /// ```
    #[must_use]
    pub fn heading(&self) -> Option<Phase> {
        match self {
            Self::Heading(heading) => Some(*heading),
            Self::Quaternion(quaternion) => quaternion_heading(quaternion),
        }
    }
}

#[inline(never)]
fn quaternion_heading(quaternion: &[i32; 4]) -> Option<Phase> {
    /// The square of the norm in units of 2⁻²⁸.
    const ONE_SQUARED: u32 = 1 << 28;
    const TOLERANCE: u32 = ONE_SQUARED / 50;
    let [w, x, y, z] = quaternion.map(i64::from);
    // Four components of −2³¹ would wrap to a norm of zero.
    let y2_z2 = (y * y) as u64 + (z * z) as u64;
    let norm_squared = ((w * w) as u64 + (x * x) as u64).wrapping_add(y2_z2);
    if ((norm_squared >> 32) as u32).abs_diff(ONE_SQUARED) > TOLERANCE {
        return None;
    }
    // Half of the formula's numerator and denominator, in units of 2⁻⁶⁰.
    Phase::atan2(w * z + x * y, (1 << 59) - y2_z2 as i64).map(|counter_clockwise| Phase::default() - counter_clockwise)
}

/// Unwraps the heading of one IMU and finds its tare.
///
/// The tare is the circular mean of the readings of the first `tare_samples` ticks; with 0 ticks the heading is
/// absolute already, and only its first reading is wrapped to ±180°. Until the tare is complete the IMU has a heading
/// but no zero, so that θ is unknown. An IMU without any reading during the tare stays without a zero.
///
/// ```
/// use estimator_core::{HeadingTracker, Phase, Turns};
///
/// let mut heading = HeadingTracker::<f64>::new(0, Turns::ZERO);
/// heading.read(Some(Phase::from_degrees(170.0)));
/// let unwrapped = heading.read(Some(Phase::from_degrees(190.0))).expect("it was read");
/// assert!((unwrapped.rad().to_degrees() - 190.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct HeadingTracker<S> {
    current: SegmentHeading,
    reference: Turns,
    tare: Tare<S>,
}

/// Heading of one IMU, and its zero.
#[derive(Debug, Clone, Copy)]
pub struct SegmentHeading {
    /// Newest reading, unwrapped, from an arbitrary zero.
    heading: Turns,
    /// Zero to subtract from the heading.
    zero: Turns,
    /// The IMU was read in this tick.
    is_read: bool,
    is_tared: bool,
}

impl SegmentHeading {
    /// Heading of the arm's base, zero.
    pub(crate) const BASE: Self = Self { heading: Turns::ZERO, zero: Turns::ZERO, is_read: true, is_tared: true };

    /// Returns `true` if the IMU was read in this tick.
    pub(crate) fn is_read(&self) -> bool {
        self.is_read
    }

    /// The newest reading, unwrapped, from an arbitrary zero.
    pub(crate) fn unwrapped(&self) -> Turns {
        self.heading
    }

    /// The newest heading in {W}, without drift correction; `None` until the tare is complete.
    pub(crate) fn in_world(&self) -> Option<Turns> {
        self.is_tared.then(|| self.heading - self.zero)
    }

    /// Heading and zero less those of the segment before; unknown where either is.
    #[inline]
    pub(crate) fn relative_to(&self, before: &Self) -> [Option<Turns>; 2] {
        [
            (self.is_read & before.is_read).then_some(self.heading - before.heading),
            (self.is_tared & before.is_tared).then_some(self.zero - before.zero),
        ]
    }
}

/// Sums of a circular mean, relative to the first reading, so that the mean is not wrapped.
#[derive(Debug, Clone, Copy)]
struct Tare<S> {
    ticks_left: u32,
    first: Option<Turns>,
    cos: Turns,
    sin: Turns,
    scalar: core::marker::PhantomData<S>,
}

impl<S: FusedOps> HeadingTracker<S> {
    /// A tracker before its first reading, for an IMU whose heading in the reference pose is `reference`.
    #[must_use]
    pub fn new(tare_samples: u32, reference: Turns) -> Self {
        let tare = Tare {
            ticks_left: tare_samples,
            first: None,
            cos: Turns::ZERO,
            sin: Turns::ZERO,
            scalar: core::marker::PhantomData,
        };
        // From a heading of zero on, the first reading is unwrapped to within ±180°.
        let current = SegmentHeading { is_read: false, is_tared: tare_samples == 0, ..SegmentHeading::BASE };
        Self { current, reference, tare }
    }

    /// Updates the heading with this tick's reading; returns it unwrapped, from an arbitrary zero, or `None` if it was
    /// not read.
    #[inline]
    pub fn read(&mut self, reading: Option<Phase>) -> Option<Turns> {
        let current = &mut self.current;
        current.is_read = reading.is_some();
        let heading = reading.map(|phase| current.heading + Turns::from(phase - current.heading.phase()));
        current.heading = heading.unwrap_or(current.heading);
        if self.tare.ticks_left > 0 {
            self.tare(heading);
        }
        heading
    }

    #[cold]
    fn tare(&mut self, heading: Option<Turns>) {
        self.tare.add(heading);
        if self.tare.ticks_left == 0
            && let Some(mean) = self.tare.mean()
        {
            (self.current.zero, self.current.is_tared) = (mean - self.reference, true);
        }
    }

    /// Zero: the heading in {W} is that of [`HeadingTracker::read`] less this; `None` until the tare is complete.
    #[must_use]
    pub fn zero(&self) -> Option<Turns> {
        self.current.is_tared.then_some(self.current.zero)
    }

    /// Heading in this tick.
    #[inline]
    pub(crate) fn segment_heading(&self) -> &SegmentHeading {
        &self.current
    }
}

impl<S: FusedOps> Tare<S> {
    fn add(&mut self, heading: Option<Turns>) {
        self.ticks_left -= 1;
        let Some(heading) = heading else { return };
        let first = *self.first.get_or_insert(heading);
        let (sin, cos) = sin_cos(Angle::<S>::from(heading - first));
        // Converted like angles, sine and cosine become integers, whose sums are exact.
        self.cos = self.cos + cos.to_turns();
        self.sin = self.sin + sin.to_turns();
    }

    fn mean(&self) -> Option<Turns> {
        let deviation = Phase::atan2(self.sin.bits(), self.cos.bits())?;
        Some(self.first? + Turns::from(deviation))
    }
}
