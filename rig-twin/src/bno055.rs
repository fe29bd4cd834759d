//! BNO055 units in IMUPLUS mode: headings that drift, in quaternions.

use crate::actuator::Lag;
use crate::arm::ImuParameters;
use crate::constants::{ACCELERATION_LAG_S, DRIFT_SESSION_SIGMA, FUSION_S, QUATERNION_UNIT_STEPS};
use crate::faults::ImuFaults;
use crate::gauss_markov::GaussMarkov;
use crate::noise::{Noise, Seeds, Source};
use crate::pose::EndPose;
use core::f64::consts::PI;

/// One unit at a segment's end.
#[derive(Clone, Debug)]
pub(crate) struct Imu {
    parameters: ImuParameters,
    mount_rad: f64,
    rate_rad_per_s: f64,
    instability: GaussMarkov,
    heading_walk: Noise,
    drift_rad: f64,
    motion: Motion,
    error: Lag,
    noise: Noise,
    quaternion: [i16; 4],
    faults: ImuFaults,
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
    pub(crate) fn new(parameters: ImuParameters, segment: usize, seeds: Seeds, pose: EndPose) -> Self {
        let of = |source| Noise::of_session(seeds, source, segment);
        let mut noise = of(Source::Imu);
        let mount_rad = noise.between((-PI, PI));
        let bias_rad_per_s = parameters.bias_rad_per_s * noise.tolerance((1.0, DRIFT_SESSION_SIGMA));
        let turn_on_rad_per_s = of(Source::TurnOn).tolerance((0.0, parameters.turn_on_rad_per_s));
        let ImuParameters { instability_rad_per_s, instability_s, .. } = parameters;
        let mut imu = Self {
            parameters,
            mount_rad,
            rate_rad_per_s: bias_rad_per_s + turn_on_rad_per_s,
            instability: GaussMarkov::new(instability_rad_per_s, instability_s, FUSION_S, of(Source::Instability)),
            heading_walk: of(Source::HeadingWalk),
            drift_rad: 0.0,
            motion: Motion { pose, velocity: [0.0; 3] },
            error: Lag::new(0.0, ACCELERATION_LAG_S, FUSION_S),
            noise,
            quaternion: [0; 4],
            faults: ImuFaults::new(of(Source::Fault)),
        };
        imu.fuse(pose, 0.0);
        imu
    }

    /// One more output of the fusion, the mount being at `pose`, the unit `temperature_k` above nominal.
    pub(crate) fn fuse(&mut self, pose: EndPose, temperature_k: f64) {
        let parameters = self.parameters;
        let (across, spin) = self.motion.acceleration(pose);
        let error = self.error.follow(parameters.error_per_acceleration * across + parameters.error_per_spin * spin);
        self.drift(temperature_k);
        let noise = parameters.heading_noise_rad * self.noise.gaussian();
        let turned = parameters.sensitivity * pose.heading_rad;
        let mut heading = self.mount_rad + turned + self.drift_rad + error + noise + self.plane_error(pose.heading_rad);
        if self.faults.step() {
            self.mount_rad -= heading;
            heading = 0.0;
        }
        heading += self.faults.jump_rad();
        let fused = quaternion(-heading, parameters.pitch_rad, parameters.roll_rad);
        self.quaternion = self.faults.output(fused, self.quaternion);
    }

    /// Integrates the rate's bias: random walk, instability, temperature, and the rate's white noise.
    fn drift(&mut self, temperature_k: f64) {
        let parameters = self.parameters;
        let root_period = libm::sqrt(FUSION_S);
        self.rate_rad_per_s += parameters.rate_walk_rad_per_s * root_period * self.noise.gaussian();
        let bias = self.rate_rad_per_s + self.instability.step() + parameters.rate_rad_per_s_per_k * temperature_k;
        self.drift_rad += bias * FUSION_S;
        self.drift_rad += parameters.heading_walk_rad * root_period * self.heading_walk.gaussian();
    }

    /// Error of the heading in a plane tilted by ε: −ε²/4 · sin 2φ, to the second order.
    fn plane_error(&self, heading_rad: f64) -> f64 {
        let tilt = self.parameters.plane_tilt_rad;
        -tilt * tilt / 4.0 * libm::sin(2.0 * (heading_rad - self.parameters.plane_direction_rad))
    }

    /// The fusion's last output: w, x, y, z; `None` without power and while it starts.
    pub(crate) fn quaternion(&self) -> Option<[i16; 4]> {
        self.faults.has_output().then_some(self.quaternion)
    }

    /// The faults on it.
    pub(crate) fn faults_mut(&mut self) -> &mut ImuFaults {
        &mut self.faults
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
