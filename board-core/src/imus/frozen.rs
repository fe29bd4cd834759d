//! An IMU that repeats itself, bit for bit, while another one turns.
//!
//! At rest an IMU may repeat itself for as long as it likes. It is stuck when it gave the same bytes for 50 ticks (0.5 s)
//! and, within at most the last 50 ticks, another IMU turned by more than 1°: that is 2 °/s, forty times the drift
//! of the worst unit and, with a noise of 0.1°, seven sigma.

use telemetry::SEGMENTS;

/// Ticks of the same bytes, and of the window in which another one must turn.
const WINDOW_TICKS: u8 = 50;

/// sin²(1°/2), in units of 2⁻⁵⁶.
const TURNED: i64 = 5_487_360_000_000;

type Quaternion = [i16; 4];

#[derive(Debug)]
pub(super) struct Frozen {
    last: Option<Quaternion>,
    repeats: u8,
    /// Ticks since `then`.
    age: u8,
    /// What all IMUs read when the window began; `None` for one that was missing since.
    then: [Option<Quaternion>; SEGMENTS],
    is_stuck: bool,
}

impl Frozen {
    pub(super) const NEVER_READ: Self =
        Self { last: None, repeats: 0, age: 0, then: [None; SEGMENTS], is_stuck: false };

    /// Takes one more reading, and `now`, what all IMUs read in the same tick. True where the reading repeats what it
    /// cannot be.
    pub(super) fn watch(&mut self, reading: Quaternion, now: &[Option<Quaternion>; SEGMENTS]) -> bool {
        if self.last != Some(reading) {
            *self = Self { last: Some(reading), then: *now, ..Self::NEVER_READ };
            return false;
        }
        self.repeats = self.repeats.saturating_add(1);
        self.age = self.age.saturating_add(1);
        // One that was missing may have started anew, with another heading: that is no turn.
        for (then, now) in self.then.iter_mut().zip(now) {
            *then = then.filter(|_| now.is_some());
        }
        if self.repeats >= WINDOW_TICKS {
            let mut pairs = self.then.iter().zip(now);
            self.is_stuck |= pairs.any(|(then, now)| then.zip(*now).is_some_and(|(then, now)| has_turned(then, now)));
        }
        if self.age >= WINDOW_TICKS {
            self.then = *now;
            self.age = 0;
        }
        self.is_stuck
    }
}

/// Whether the rotation from one to the other is of more than 1°. The vector part of conj(a)·b is sin(angle/2), which
/// unlike the scalar part, its cosine, is not lost in the rounding of small angles, and does not mind q = −q. It is
/// at most the product of the norms, and the readings are of norm 1 within 1 %: nothing overflows.
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
    fn one_degree_is_a_turn_and_noise_is_not() {
        for heading in [0.0, 45.0, 180.0, 359.7, 720.0] {
            let start = about_z(heading);
            assert!(has_turned(start, about_z(heading + 1.05)), "from {heading}°");
            assert!(has_turned(start, about_z(heading - 1.05)), "from {heading}°");
            assert!(!has_turned(start, about_z(heading + 0.95)), "from {heading}°");
            assert!(!has_turned(start, start.map(|component| -component)), "at {heading}°");
        }
    }
}
