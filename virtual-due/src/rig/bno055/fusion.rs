//! The fusion's output, from the orientation that the twin gives.

use libm::{asin, atan2, sqrt};
use std::f64::consts::{PI, TAU};

/// A quaternion's 1, in its unit (data sheet 3.6.5.5).
const UNIT: f64 = 16384.0;
/// Gravity in 0.01 m/s².
const GRAVITY: f64 = 980.665;

/// Contents of the data registers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output {
    /// w, x, y, z in 1/16384.
    pub quaternion: [i16; 4],
    /// Heading in [0, 2π), roll and pitch, rad.
    pub euler_rad: [f64; 3],
    /// Gravity in the unit's frame, 0.01 m/s².
    pub gravity: [i16; 3],
}

/// Reference of the fusion's heading.
#[derive(Debug, Clone, Copy, Default)]
enum Heading {
    /// The twin's own, as at its power-up.
    #[default]
    Given,
    /// The next output is zero.
    ZeroAtNext,
    /// The twin's, turned by these w and z.
    Turned(f64, f64),
}

/// The fusion.
#[derive(Debug, Clone, Default)]
pub struct Fusion {
    heading: Heading,
    ran: bool,
}

impl Fusion {
    /// Stops the fusion. When it starts again its heading begins at zero, as IMUPLUS has no reference to north (data sheet
    /// 3.3.3.1).
    pub fn begin_again(&mut self) {
        if self.ran {
            self.heading = Heading::ZeroAtNext;
        }
    }

    /// The fusion's output at an orientation of the twin.
    pub fn output(&mut self, orientation: [i16; 4]) -> Output {
        self.ran = true;
        let [w, x, y, z] = orientation.map(f64::from);
        if let Heading::ZeroAtNext = self.heading {
            let norm = sqrt(w * w + z * z);
            self.heading = if norm > 0.0 { Heading::Turned(w / norm, -z / norm) } else { Heading::Given };
        }
        let quaternion = match self.heading {
            Heading::Turned(c, s) => {
                [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w].map(|part| part.round() as i16)
            }
            _ => orientation,
        };
        Output { quaternion, euler_rad: euler(quaternion), gravity: gravity(quaternion) }
    }
}

/// Heading clockwise positive seen from above, roll, pitch.
fn euler(quaternion: [i16; 4]) -> [f64; 3] {
    let [w, x, y, z] = quaternion.map(|part| f64::from(part) / UNIT);
    let heading = -atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    let roll = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    let pitch = asin((2.0 * (w * y - x * z)).clamp(-1.0, 1.0));
    [if heading < 0.0 { heading + TAU } else { heading }, roll.clamp(-PI, PI), pitch]
}

/// Gravity in the frame of a unit with this orientation, 0.01 m/s².
pub fn gravity(quaternion: [i16; 4]) -> [i16; 3] {
    let [w, x, y, z] = quaternion.map(|part| f64::from(part) / UNIT);
    [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z]
        .map(|part| (GRAVITY * part).round() as i16)
}
