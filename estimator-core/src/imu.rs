//! One IMU's heading: unwrapped from reading to reading, and tared while the arm rests in its reference pose.

use crate::angle::{Angle, Phase, Turns};
use crate::pcc::Arc;
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
    newest: Option<Turns>,
    zero: Option<Turns>,
    reference: Turns,
    tare: Tare<S>,
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
        let zero = (tare_samples == 0).then_some(Turns::ZERO);
        let tare = Tare {
            ticks_left: tare_samples,
            first: None,
            cos: Turns::ZERO,
            sin: Turns::ZERO,
            scalar: core::marker::PhantomData,
        };
        Self { newest: None, zero, reference, tare }
    }

    /// Takes this tick's reading; gives the heading unwrapped, counted from anywhere, or `None` where it was not read.
    pub fn read(&mut self, reading: Option<Phase>) -> Option<Turns> {
        let heading = reading.map(|phase| match self.newest {
            None => Turns::from(phase),
            Some(newest) => newest + Turns::from(phase - newest.phase()),
        });
        self.newest = heading.or(self.newest);
        if self.tare.ticks_left > 0 {
            self.tare.add(heading);
            if self.tare.ticks_left == 0 {
                self.zero = self.tare.mean().map(|mean| mean - self.reference);
            }
        }
        heading
    }

    /// What to subtract from [`Heading::read`] to get the heading in {W}; `None` until the tare is complete.
    #[must_use]
    pub fn zero(&self) -> Option<Turns> {
        self.zero
    }
}

impl<S: Scalar> Tare<S> {
    #[cold]
    fn add(&mut self, heading: Option<Turns>) {
        self.ticks_left -= 1;
        let Some(heading) = heading else { return };
        let first = *self.first.get_or_insert(heading);
        let deviation = Arc::<S>::new(Angle::from(heading - first));
        // Read as angles, sine and cosine become whole numbers, whose sums are exact.
        self.cos = self.cos + deviation.cos.to_turns();
        self.sin = self.sin + deviation.sin.to_turns();
    }

    #[cold]
    fn mean(&self) -> Option<Turns> {
        let deviation = Phase::atan2(self.sin.bits(), self.cos.bits())?;
        Some(self.first? + Turns::from(deviation))
    }
}
