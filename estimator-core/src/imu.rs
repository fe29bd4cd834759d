//! One IMU's heading: unwrapped from reading to reading, and tared while the arm rests in its reference pose.

use crate::angle::{Angle, Phase, Turns};
use crate::pcc::sin_cos;
use crate::scalar::Scalar;

/// Unwraps the heading of one IMU and finds its tare.
///
/// The tare is the circular mean of the readings of the first `tare_samples` ticks; with 0 ticks the heading is absolute
/// already, and only its first reading is wrapped to ±180°. Until the tare is complete the IMU has a heading but no
/// zero, so that nothing can be said of θ. An IMU that was never read meanwhile stays without a zero.
///
/// ```
/// use estimator_core::{Heading, Phase, Turns};
///
/// let mut heading = Heading::<f64>::new(0, Turns::ZERO);
/// heading.read(Some(Phase::from_degrees(170.0)));
/// let unwrapped = heading.read(Some(Phase::from_degrees(190.0))).expect("it was read");
/// assert!((unwrapped.rad().to_degrees() - 190.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Heading<S> {
    tangent: Tangent,
    reference: Turns,
    tare: Tare<S>,
}

/// Where one IMU points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tangent {
    /// Unwrapped, counted from anywhere; the newest that was read.
    heading: Turns,
    /// What to subtract from it.
    zero: Turns,
    /// In this tick.
    is_read: bool,
    is_tared: bool,
}

impl Tangent {
    /// The arm's base, from which headings count.
    pub(crate) const BASE: Self = Self { heading: Turns::ZERO, zero: Turns::ZERO, is_read: true, is_tared: true };

    /// Heading and zero less those of the segment before; unknown where either is.
    #[inline]
    pub(crate) fn minus(&self, before: &Self) -> [Option<Turns>; 2] {
        [
            (self.is_read & before.is_read).then_some(self.heading - before.heading),
            (self.is_tared & before.is_tared).then_some(self.zero - before.zero),
        ]
    }
}

/// The sums behind a circular mean, relative to the first reading, so that the mean is found without wrapping it.
#[derive(Debug, Clone, Copy)]
struct Tare<S> {
    ticks_left: u32,
    first: Option<Turns>,
    cos: Turns,
    sin: Turns,
    scalar: core::marker::PhantomData<S>,
}

impl<S: Scalar> Heading<S> {
    /// An IMU that was not read yet, whose heading in the reference pose is `reference`.
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
        let tangent = Tangent { is_read: false, is_tared: tare_samples == 0, ..Tangent::BASE };
        Self { tangent, reference, tare }
    }

    /// Takes this tick's reading; gives the heading unwrapped, counted from anywhere, or `None` where it was not read.
    #[inline]
    pub fn read(&mut self, reading: Option<Phase>) -> Option<Turns> {
        let tangent = &mut self.tangent;
        tangent.is_read = reading.is_some();
        let heading = reading.map(|phase| tangent.heading + Turns::from(phase - tangent.heading.phase()));
        tangent.heading = heading.unwrap_or(tangent.heading);
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
            (self.tangent.zero, self.tangent.is_tared) = (mean - self.reference, true);
        }
    }

    /// What to subtract from [`Heading::read`] to get the heading in {W}; `None` until the tare is complete.
    #[must_use]
    pub fn zero(&self) -> Option<Turns> {
        self.tangent.is_tared.then_some(self.tangent.zero)
    }

    /// Of this tick.
    #[inline]
    pub(crate) fn tangent(&self) -> &Tangent {
        &self.tangent
    }
}

impl<S: Scalar> Tare<S> {
    fn add(&mut self, heading: Option<Turns>) {
        self.ticks_left -= 1;
        let Some(heading) = heading else { return };
        let first = *self.first.get_or_insert(heading);
        let (sin, cos) = sin_cos(Angle::<S>::from(heading - first));
        // Read as angles, sine and cosine become whole numbers, whose sums are exact.
        self.cos = self.cos + cos.to_turns();
        self.sin = self.sin + sin.to_turns();
    }

    fn mean(&self) -> Option<Turns> {
        let deviation = Phase::atan2(self.sin.bits(), self.cos.bits())?;
        Some(self.first? + Turns::from(deviation))
    }
}
