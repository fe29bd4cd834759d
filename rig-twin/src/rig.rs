//! The rig: arm, contacts and sensors on one fixed grid of time.

use crate::actuator::{Actuator, Regulator};
use crate::arm::ArmParameters;
use crate::bno055::Imu;
use crate::constants::{
    BEND_SENSORS, FUSION_S, GRID_POINTS_PER_FUSION, GRID_S, GRID_SLACK_S, LEAD_IN_S, LONGEST_STEP_S, REGULATORS,
    SEGMENTS,
};
use crate::contact::{Contacts, Push};
use crate::flex::{BendSensor, PairError, PairErrors};
use crate::noise::{Noise, Source};
use crate::pose::EndPose;
use crate::program::MotionProgram;
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::shape::{Curve, poses};
use crate::temperature::Temperature;
use core::array::from_fn;

/// The simulated arm with its regulators, bend sensors and IMUs.
///
/// The arm's tolerances depend on the arm's seed alone, so that a calibration from one session holds in another of the
/// same arm. The session's seed draws the properties of a session: noise, contacts, power-up headings, turn-on biases,
/// temperature, and the stored creep of the strips.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Time since the start of the session in grid steps; negative before it.
    grid_points: i64,
    pending_s: f64,
    regulators: [Regulator; REGULATORS],
    actuators: [Actuator; SEGMENTS],
    contacts: Contacts,
    curves: [Curve; SEGMENTS],
    bend_sensors: [BendSensor; BEND_SENSORS],
    pair_errors: [PairErrors; SEGMENTS],
    pair_error: [PairError; SEGMENTS],
    temperature: Temperature,
    temperature_k: f64,
    imus: [Imu; SEGMENTS],
    converter_noise: Noise,
}

impl Rig {
    /// The reference arm at rest, vented and straight, in the session of `seed`. The scenario selects the contacts.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        Self::of(&Setup::new(scenario, seed))
    }

    /// The arm of a session at its start.
    pub fn of(setup: &Setup) -> Self {
        let mut rig = Self::at_rest(setup);
        if !setup.motion.starts_at_rest() {
            let program = MotionProgram::of(setup);
            rig.grid_points = -(LEAD_IN_S / GRID_S) as i64;
            while rig.grid_points < 0 {
                rig.advance(program.duties(rig.time_s()));
            }
        }
        rig
    }

    /// The arm, vented and straight.
    fn at_rest(setup: &Setup) -> Self {
        let (arm, seeds) = (ArmParameters::new(setup.arm_seed), setup.seeds());
        let curves = arm.curves.map(Curve::new);
        let poses = poses(&curves);
        Self {
            grid_points: 0,
            pending_s: 0.0,
            regulators: arm.regulators.map(Regulator::vented),
            actuators: arm.actuators.map(Actuator::new),
            contacts: Contacts::new(setup.scenario, seeds),
            curves,
            bend_sensors: from_fn(|index| BendSensor::new(arm.strips[index], index, seeds)),
            pair_errors: from_fn(|segment| PairErrors::new(arm.pairs[segment], segment, seeds)),
            pair_error: [PairError::default(); SEGMENTS],
            temperature: Temperature::new(seeds, FUSION_S),
            temperature_k: 0.0,
            imus: from_fn(|segment| Imu::new(arm.imus[segment], segment, seeds, poses[segment])),
            converter_noise: Noise::of_session(seeds, Source::Converter, 0),
        }
    }

    /// Advances by `dt_s` seconds at these duties, 0 … 1: module 1 right, left, module 2 right, left, module 3 right,
    /// left.
    ///
    /// The physics advances on a grid of 2 ms and the remainder is carried over, so that the state does not depend on
    /// the sizes of the steps. A step that is not positive has no effect; one above an hour counts as an hour. A duty
    /// of NaN counts as 0.
    pub fn step(&mut self, dt_s: f64, duties: [f64; REGULATORS]) {
        if dt_s > 0.0 {
            self.pending_s += dt_s.min(LONGEST_STEP_S);
        }
        while self.pending_s >= GRID_S - GRID_SLACK_S {
            self.pending_s -= GRID_S;
            self.advance(duties);
        }
    }

    /// One grid step.
    fn advance(&mut self, duties: [f64; REGULATORS]) {
        self.grid_points += 1;
        let pressures_pa: [f64; REGULATORS] = from_fn(|index| self.regulators[index].step(duties[index]));
        let free_rad: [f64; SEGMENTS] = from_fn(|segment| {
            let [right, left] = of_segment(&pressures_pa, segment);
            self.actuators[segment].step(right - left)
        });
        let touches = self.contacts.touches(self.grid_points as f64 * GRID_S, &free_rad);
        for (segment, curve) in self.curves.iter_mut().enumerate() {
            curve.bend(free_rad[segment], touches[segment], of_segment(&pressures_pa, segment));
        }
        for (index, sensor) in self.bend_sensors.iter_mut().enumerate() {
            sensor.step(&self.curves[index / 2], self.pair_error[index / 2], self.temperature_k);
        }
        if self.grid_points % GRID_POINTS_PER_FUSION == 0 {
            self.temperature_k = self.temperature.step();
            self.pair_error = from_fn(|segment| self.pair_errors[segment].step(self.temperature_k));
            for (imu, pose) in self.imus.iter_mut().zip(poses(&self.curves)) {
                imu.fuse(pose, self.temperature_k);
            }
        }
    }

    /// Time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.grid_points as f64 * GRID_S + self.pending_s
    }

    /// True world pose of each segment's end, at the last grid point.
    pub fn truth(&self) -> [EndPose; SEGMENTS] {
        poses(&self.curves)
    }

    /// Fresh conversions of the bend sensors, 0 … 4095, in the order 1a, 1b, 2a, … 6b. Each call draws new noise.
    pub fn adc_counts(&mut self) -> [u16; BEND_SENSORS] {
        from_fn(|index| self.convert(index))
    }

    /// One fresh conversion of one bend sensor, counted from 0 in the order of [`adc_counts`](Self::adc_counts), for a
    /// converter that samples one channel after the other.
    ///
    /// # Panics
    ///
    /// If `sensor` is not below [`BEND_SENSORS`].
    pub fn convert(&mut self, sensor: usize) -> u16 {
        self.bend_sensors[sensor].convert(&mut self.converter_noise)
    }

    /// The IMUs' last fusion output, at most 10 ms old: w, x, y, z of each segment's unit, in steps of 1/16384.
    pub fn imu_quaternions(&self) -> [[i16; 4]; SEGMENTS] {
        from_fn(|segment| self.imus[segment].quaternion())
    }

    /// Bend angle that contacts add to each segment now, rad; 0 without contact.
    pub fn contact_bends_rad(&self) -> [f64; SEGMENTS] {
        self.curves.map(|curve| curve.touch.bend_rad)
    }

    /// The pushes of scenario II that have begun, oldest first; none in the other scenarios.
    pub fn pushes(&self) -> &[Push] {
        self.contacts.pushes()
    }
}

/// Right and left value of the module that a segment belongs to.
fn of_segment(regulators: &[f64; REGULATORS], segment: usize) -> [f64; 2] {
    let right = 2 * (segment / 2);
    [regulators[right], regulators[right + 1]]
}
