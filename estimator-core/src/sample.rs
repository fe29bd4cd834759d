//! What a board reads in one tick, before any interpretation.

use crate::angle::Phase;

/// Bend sensors that a segment can carry: `a` and `b`.
pub const SENSORS_PER_SEGMENT: usize = 2;

/// The raw readings of one tick, for an arm of up to `N` segments. A missing reading is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize> {
    /// Time of the tick, µs.
    pub time_us: u64,
    /// Raw ADC counts, 0…4095, of each segment's bend sensors a and b.
    pub bend: [[Option<u16>; SENSORS_PER_SEGMENT]; N],
    /// Raw reading of the IMU at each segment's end.
    pub imu: [Option<ImuReading>; N],
}

impl<const N: usize> Sample<N> {
    /// A sample at `time_us` in which nothing was read.
    #[must_use]
    pub const fn missing(time_us: u64) -> Self {
        Self { time_us, bend: [[None; SENSORS_PER_SEGMENT]; N], imu: [None; N] }
    }
}

/// The raw orientation of one IMU, mounted z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImuReading {
    /// The heading alone.
    Heading(Phase),
    /// A unit quaternion w, x, y, z in units of 2⁻³⁰.
    Quaternion([i32; 4]),
}

impl ImuReading {
    /// From a BNO055's quaternion registers w, x, y, z in units of 2⁻¹⁴ (datasheet 3.6.5.5). Exact.
    #[must_use]
    pub const fn from_bno055([w, x, y, z]: [i16; 4]) -> Self {
        Self::Quaternion([(w as i32) << 16, (x as i32) << 16, (y as i32) << 16, (z as i32) << 16])
    }

    /// The heading, clockwise positive seen from above: h = −atan2(2(wz + xy), 1 − 2(y² + z²)).
    ///
    /// `None` for what cannot be an orientation: a quaternion whose norm is over 1 % from 1 (all zero after a
    /// brown-out, say), or a sensor whose x axis points straight up or down.
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
    // Four times −2³¹ would wrap, to a norm of zero.
    let y2_z2 = (y * y) as u64 + (z * z) as u64;
    let norm_squared = ((w * w) as u64 + (x * x) as u64).wrapping_add(y2_z2);
    if ((norm_squared >> 32) as u32).abs_diff(ONE_SQUARED) > TOLERANCE {
        return None;
    }
    // Half of the formula's numerator and denominator, in units of 2⁻⁶⁰.
    Phase::atan2(w * z + x * y, (1 << 59) - y2_z2 as i64).map(|counter_clockwise| Phase::default() - counter_clockwise)
}
