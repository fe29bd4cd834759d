//! A supposed wiring of the sensors.

use calibration_tables::MAX_SEGMENTS;

/// Wiring of the IMUs and of the segments' bend sensors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wiring {
    pub imu: [usize; MAX_SEGMENTS],
    pub gain: [f64; MAX_SEGMENTS],
    pub bend: [usize; MAX_SEGMENTS],
    pub bend_sign: [f64; MAX_SEGMENTS],
}

/// A supposed fault.
#[derive(Debug, Clone, Copy)]
pub(super) enum Fault {
    Gain(Option<usize>, f64),
    Imus(usize, usize),
    Bends(usize, usize),
    BendSign(usize),
}

impl Wiring {
    /// Each sensor in its own place.
    pub fn in_order() -> Self {
        let own = std::array::from_fn(|i| i);
        Self { imu: own, gain: [1.0; MAX_SEGMENTS], bend: own, bend_sign: [1.0; MAX_SEGMENTS] }
    }

    /// This wiring with a fault.
    pub fn with(mut self, fault: Fault) -> Self {
        match fault {
            Fault::Gain(None, gain) => self.gain.iter_mut().for_each(|own| *own *= gain),
            Fault::Gain(Some(i), gain) => self.gain[i] *= gain,
            Fault::Imus(i, j) => self.imu.swap(i, j),
            Fault::Bends(i, j) => self.bend.swap(i, j),
            Fault::BendSign(i) => self.bend_sign[i] = -self.bend_sign[i],
        }
        self
    }
}
