//! BNO055 units in IMUPLUS mode: headings that drift, in quaternions.

use crate::actuator::Lag;
use crate::constants::{
    ACCELERATION_LAG_S, DRIFT_RAD_PER_S, DRIFT_SESSION_SIGMA, DRIFT_WALK_RAD_PER_S,
    ERROR_PER_ACCELERATION_RAD_S2_PER_M, ERROR_PER_SPIN_S2, FUSION_S, GYRO_SENSITIVITY_SIGMA, HEADING_NOISE_RAD,
    QUATERNION_UNIT_STEPS, TILT_SIGMA_RAD,
};
use crate::noise::{Noise, Source};
use crate::shape::EndPose;
use core::f64::consts::PI;

/// One unit at a segment's end.
#[derive(Clone, Debug)]
pub(crate) struct Imu {
    mount_rad: f64,
    sensitivity: f64,
    pitch_rad: f64,
    roll_rad: f64,
    rate_rad_per_s: f64,
    walk_rad_per_s: f64,
    drift_rad: f64,
    motion: Motion,
    error: Lag,
    noise: Noise,
    quaternion: [i16; 4],
}

/// The mount's last pose and velocity, from which its acceleration follows.
#[derive(Clone, Copy, Debug)]
struct Motion {
    pose: EndPose,
    velocity: [f64; 3],
}

impl Motion {
    /// Acceleration to the mount's right in m/s² and of its heading in rad/s², over the last fusion period.
    fn acceleration(&mut self, pose: EndPose) -> (f64, f64) {
        let velocity = [pose.x_m - self.pose.x_m, pose.y_m - self.pose.y_m, pose.heading_rad - self.pose.heading_rad]
            .map(|difference| difference / FUSION_S);
        let [x, y, spin] = core::array::from_fn(|axis| (velocity[axis] - self.velocity[axis]) / FUSION_S);
        *self = Self { pose, velocity };
        let (sin, cos) = libm::sincos(pose.heading_rad);
        (x * cos - y * sin, spin)
    }
}

impl Imu {
    /// The unit of segment `segment`, counted from 0, that powers up at `pose`, with any heading.
    pub(crate) fn new(segment: usize, seed: u64, pose: EndPose) -> Self {
        let mut arm = Noise::of_arm(Source::Imu, segment);
        let mut noise = Noise::of_session(seed, Source::Imu, segment);
        let mut imu = Self {
            mount_rad: noise.between((-PI, PI)),
            sensitivity: arm.tolerance((1.0, GYRO_SENSITIVITY_SIGMA)),
            pitch_rad: arm.tolerance((0.0, TILT_SIGMA_RAD)),
            roll_rad: arm.tolerance((0.0, TILT_SIGMA_RAD)),
            rate_rad_per_s: DRIFT_RAD_PER_S[segment] * noise.tolerance((1.0, DRIFT_SESSION_SIGMA)),
            walk_rad_per_s: DRIFT_WALK_RAD_PER_S * libm::sqrt(FUSION_S),
            drift_rad: 0.0,
            motion: Motion { pose, velocity: [0.0; 3] },
            error: Lag::new(0.0, ACCELERATION_LAG_S, FUSION_S),
            noise,
            quaternion: [0; 4],
        };
        imu.fuse(pose);
        imu
    }

    /// One more output of the fusion, the mount being at `pose`.
    pub(crate) fn fuse(&mut self, pose: EndPose) {
        let (across, spin) = self.motion.acceleration(pose);
        let error = self.error.follow(ERROR_PER_ACCELERATION_RAD_S2_PER_M * across + ERROR_PER_SPIN_S2 * spin);
        self.rate_rad_per_s += self.walk_rad_per_s * self.noise.gaussian();
        self.drift_rad += self.rate_rad_per_s * FUSION_S;
        let noise = HEADING_NOISE_RAD * self.noise.gaussian();
        let heading = self.mount_rad + self.sensitivity * pose.heading_rad + self.drift_rad + error + noise;
        self.quaternion = quaternion(-heading, self.pitch_rad, self.roll_rad);
    }

    /// The fusion's last output: w, x, y, z.
    pub(crate) fn quaternion(&self) -> [i16; 4] {
        self.quaternion
    }
}

/// q_z(yaw) q_y(pitch) q_x(roll) in the unit's steps. Half the unwrapped yaw turns it through q → −q as a real unit does.
fn quaternion(yaw: f64, pitch: f64, roll: f64) -> [i16; 4] {
    let (sy, cy) = libm::sincos(yaw / 2.0);
    let (sp, cp) = libm::sincos(pitch / 2.0);
    let (sr, cr) = libm::sincos(roll / 2.0);
    let unit = [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ];
    unit.map(|component| (component * QUATERNION_UNIT_STEPS).round() as i16)
}

#[cfg(test)]
mod tests {
    use super::quaternion;

    #[test]
    fn heading_of_a_tilted_quaternion_is_its_negative_yaw() {
        let [w, x, y, z] = quaternion(-0.7, 0.03, -0.05).map(|step| f64::from(step) / 16384.0);
        let heading = -(2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
        assert!((heading - 0.7).abs() < 2e-4, "{heading} rad");
    }
}
