//! Detector of a stuck IMU: one that repeats its reading, bit for bit, while another one turns.
//!
//! At rest an IMU may repeat its reading for any time. It is stuck if it gave the same bytes for 50 ticks (0.5 s) and,
//! within at most the last 50 ticks, another IMU turned by more than 0.5°: that is 1 °/s, twenty times the drift of the
//! worst unit. The noise of another IMU does not reach it where this one's is so small that its bytes repeat.

use telemetry::MAX_SEGMENTS;

/// Ticks of the same bytes, and of the window in which another IMU must turn.
const WINDOW_TICKS: u8 = 50;

/// sin²(0.5°/2), in units of 2⁻⁵⁶.
const TURNED: i64 = 1_371_866_000_000;

type Quaternion = [i16; 4];

#[derive(Debug)]
pub(super) struct StuckDetector {
    last: Option<Quaternion>,
    repeats: u8,
    /// Ticks since `reference`.
    age: u8,
    /// Readings of all IMUs at the beginning of the window; `None` for an IMU that was missing since.
    reference: [Option<Quaternion>; MAX_SEGMENTS],
    is_stuck: bool,
}

impl StuckDetector {
    pub(super) const NEVER_READ: Self =
        Self { last: None, repeats: 0, age: 0, reference: [None; MAX_SEGMENTS], is_stuck: false };

    /// Updates the detector with a reading and with `now`, the readings of all IMUs in the same tick. Returns whether the
    /// IMU is stuck.
    pub(super) fn update(&mut self, reading: Quaternion, now: &[Option<Quaternion>; MAX_SEGMENTS]) -> bool {
        if self.last != Some(reading) {
            *self = Self { last: Some(reading), reference: *now, ..Self::NEVER_READ };
            return false;
        }
        self.repeats = self.repeats.saturating_add(1);
        self.age = self.age.saturating_add(1);
        // An IMU that was missing may have restarted, with another heading: that is no turn.
        for (reference, now) in self.reference.iter_mut().zip(now) {
            *reference = reference.filter(|_| now.is_some());
        }
        if self.repeats >= WINDOW_TICKS {
            let mut pairs = self.reference.iter().zip(now).filter_map(|(reference, now)| reference.zip(*now));
            self.is_stuck |= pairs.any(|(reference, now)| has_turned(reference, now));
        }
        if self.age >= WINDOW_TICKS {
            self.reference = *now;
            self.age = 0;
        }
        self.is_stuck
    }
}

/// Returns whether the rotation from one to the other is of more than 0.5°. The norm of the vector part of conj(a)·b is
/// sin(angle/2), which unlike the scalar part, its cosine, is not lost in the rounding of small angles, and is the same
/// for q and −q. It is at most the product of the norms, and the readings are of norm 1 within 1 %: nothing overflows.
fn has_turned(a: Quaternion, b: Quaternion) -> bool {
    let [[aw, ax, ay, az], [bw, bx, by, bz]] = [a, b].map(|q| q.map(i64::from));
    let x = aw * bx - ax * bw - ay * bz + az * by;
    let y = aw * by - ay * bw - az * bx + ax * bz;
    let z = aw * bz - az * bw - ax * by + ay * bx;
    x * x + y * y + z * z > TURNED
}

#[cfg(test)]
mod tests {
    use super::has_turned;

    /// A turn by `degrees` about z.
    fn about_z(degrees: f64) -> [i16; 4] {
        let half = degrees.to_radians() / 2.0;
        [half.cos(), 0.0, 0.0, half.sin()].map(|component| (component * 16384.0).round() as i16)
    }

    #[test]
    fn half_a_degree_is_a_turn_and_rounding_is_not() {
        for heading in [0.0, 45.0, 180.0, 359.7, 720.0] {
            let start = about_z(heading);
            assert!(has_turned(start, about_z(heading + 0.53)), "from {heading}°");
            assert!(has_turned(start, about_z(heading - 0.53)), "from {heading}°");
            assert!(!has_turned(start, about_z(heading + 0.47)), "from {heading}°");
            assert!(!has_turned(start, start.map(|component| -component)), "at {heading}°");
        }
    }
}
