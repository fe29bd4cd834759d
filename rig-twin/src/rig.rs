//! The rig: arm, contacts and sensors on one fixed grid of time.

use crate::actuator::{Actuator, Regulator};
use crate::arm::ArmParameters;
use crate::bno055::Imu;
use crate::constants::{
    FUSION_S, GRID_POINTS_PER_FUSION, GRID_S, GRID_SLACK_S, LEAD_IN_S, LONGEST_STEP_S, SEGMENTS_PER_MODULE,
    SENSORS_PER_SEGMENT,
};
use crate::contact::{Contacts, Push};
use crate::faults::{Fault, FaultError, SensorFaults, TimedFault};
use crate::flex::{BendSensor, PairError, PairErrors};
use crate::layout::{PerBendSensor, PerRegulator, PerSegment};
use crate::noise::{Noise, Source};
use crate::pose::EndPose;
use crate::program::MotionProgram;
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::shape::{Curve, poses};
use crate::temperature::Temperature;

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
    regulators: PerRegulator<Regulator>,
    actuators: PerSegment<Actuator>,
    contacts: Contacts,
    curves: PerSegment<Curve>,
    bend_sensors: PerBendSensor<Option<BendSensor>>,
    pair_errors: PerSegment<PairErrors>,
    pair_error: PerSegment<PairError>,
    temperature: Temperature,
    temperature_k: f64,
    imus: PerSegment<Option<Imu>>,
    converter_noise: Noise,
    faults: SensorFaults,
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
                rig.advance(&program.duties(rig.time_s()));
            }
        }
        rig
    }

    /// The arm, vented and straight.
    fn at_rest(setup: &Setup) -> Self {
        let (arm, seeds) = (ArmParameters::new(setup.arm_seed, &setup.layout), setup.seeds());
        let curves: PerSegment<Curve> = arm.curves.into_iter().map(Curve::new).collect();
        let strips = arm.strips.into_iter().enumerate();
        let pairs = arm.pairs.into_iter().enumerate();
        let imus = arm.imus.into_iter().zip(poses(&curves)).enumerate();
        Self {
            grid_points: 0,
            pending_s: 0.0,
            regulators: arm.regulators.into_iter().map(Regulator::vented).collect(),
            actuators: arm.actuators.into_iter().map(Actuator::new).collect(),
            contacts: Contacts::new(setup.scenario, &setup.layout, seeds),
            bend_sensors: strips.map(|(index, strip)| Some(BendSensor::new(strip?, index, seeds))).collect(),
            pair_error: curves.iter().map(|_| PairError::default()).collect(),
            pair_errors: pairs.map(|(segment, pair)| PairErrors::new(pair, segment, seeds)).collect(),
            temperature: Temperature::new(seeds, FUSION_S),
            temperature_k: 0.0,
            imus: imus.map(|(segment, (imu, pose))| Some(Imu::new(imu?, segment, seeds, pose))).collect(),
            curves,
            converter_noise: Noise::of_session(seeds, Source::Converter, 0),
            faults: SensorFaults::default(),
        }
    }

    /// Advances by `dt_s` seconds at these duties, 0 … 1: module 1 right, left, module 2 right, left, …
    ///
    /// The physics advances on a grid of 2 ms and the remainder is carried over, so that the state does not depend on
    /// the sizes of the steps. A step that is not positive has no effect; one above an hour counts as an hour. A duty
    /// of NaN counts as 0, as does one that is missing; those beyond the arm's regulators have no effect.
    pub fn step(&mut self, dt_s: f64, duties: &[f64]) {
        if dt_s > 0.0 {
            self.pending_s += dt_s.min(LONGEST_STEP_S);
        }
        while self.pending_s >= GRID_S - GRID_SLACK_S {
            self.pending_s -= GRID_S;
            self.advance(duties);
        }
    }

    /// One grid step.
    fn advance(&mut self, duties: &[f64]) {
        self.grid_points += 1;
        let duties = duties.iter().copied().chain(core::iter::repeat(0.0));
        let pressures_pa: PerRegulator<f64> =
            self.regulators.iter_mut().zip(duties).map(|(regulator, duty)| regulator.step(duty)).collect();
        let actuators = self.actuators.iter_mut().enumerate();
        let free_rad = actuators.map(|(segment, actuator)| {
            let [right, left] = of_segment(&pressures_pa, segment);
            actuator.step(right - left)
        });
        let free_rad: PerSegment<f64> = free_rad.collect();
        let touches = self.contacts.touches(self.grid_s(), &free_rad);
        for (segment, curve) in self.curves.iter_mut().enumerate() {
            curve.bend(free_rad[segment], touches[segment], of_segment(&pressures_pa, segment));
        }
        for (index, sensor) in self.bend_sensors.iter_mut().enumerate() {
            let segment = index / SENSORS_PER_SEGMENT;
            if let Some(sensor) = sensor {
                sensor.step(&self.curves[segment], self.pair_error[segment], self.temperature_k);
            }
        }
        self.apply_imu_faults();
        if self.grid_points % GRID_POINTS_PER_FUSION == 0 {
            self.temperature_k = self.temperature.step();
            self.pair_error = self.pair_errors.iter_mut().map(|errors| errors.step(self.temperature_k)).collect();
            for (imu, pose) in self.imus.iter_mut().zip(poses(&self.curves)) {
                if let Some(imu) = imu {
                    imu.fuse(pose, self.temperature_k);
                }
            }
        }
    }

    /// Lets a sensor fail. Two faults of one sensor act one after the other, in the order of these calls.
    ///
    /// # Errors
    /// [`FaultError::NotOnArm`] for a sensor that the arm does not have, [`FaultError::NotInSession`] for a fault that
    /// does not act on a sensor's readings.
    pub fn inject(&mut self, timed: TimedFault) -> Result<(), FaultError> {
        let has_bend = |index| self.bend_sensors.get(index).is_some_and(Option::is_some);
        let has_imu = |segment| self.imus.get(segment).is_some_and(Option::is_some);
        let fault = timed.fault;
        if !(fault.bend_sensor().is_none_or(has_bend) && fault.imu().is_none_or(has_imu)) {
            return Err(FaultError::NotOnArm(fault.to_string()));
        }
        self.faults.add(timed)?;
        self.apply_imu_faults();
        Ok(())
    }

    /// Ends a fault now.
    pub fn clear(&mut self, fault: Fault) {
        self.faults.end(fault, self.grid_s());
        self.apply_imu_faults();
    }

    fn apply_imu_faults(&mut self) {
        if self.faults.is_empty() {
            return;
        }
        let time_s = self.grid_s();
        for (segment, imu) in self.imus.iter_mut().enumerate() {
            if let Some(imu) = imu {
                self.faults.apply_to_imu(segment, imu.faults_mut(), time_s);
            }
        }
    }

    /// Time of the last grid point, s.
    fn grid_s(&self) -> f64 {
        self.grid_points as f64 * GRID_S
    }

    /// Time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.grid_s() + self.pending_s
    }

    /// True world pose of each segment's end, at the last grid point.
    pub fn truth(&self) -> PerSegment<EndPose> {
        poses(&self.curves)
    }

    /// Fresh conversions of the bend sensors, 0 … 4095, in the order 1a, 1b, 2a, …; `None`: no such sensor. Each call
    /// draws new noise.
    pub fn adc_counts(&mut self) -> PerBendSensor<Option<u16>> {
        (0..self.bend_sensors.len()).map(|index| self.convert(index)).collect()
    }

    /// One fresh conversion of one bend sensor, counted from 0 in the order of [`adc_counts`](Self::adc_counts), for a
    /// converter that samples one channel after the other; `None`: no such sensor.
    pub fn convert(&mut self, sensor: usize) -> Option<u16> {
        let counts = self.bend_sensors.get(sensor)?.as_ref()?.convert(&mut self.converter_noise);
        Some(self.faults.convert(sensor, counts, self.grid_s()))
    }

    /// The IMUs' last fusion output, at most 10 ms old: w, x, y, z of each segment's unit, in steps of 1/16384; `None`:
    /// no such unit, or one that a fault silences.
    pub fn imu_quaternions(&self) -> PerSegment<Option<[i16; 4]>> {
        self.imus.iter().map(|imu| imu.as_ref().and_then(Imu::quaternion)).collect()
    }

    /// Bend angle that contacts add to each segment now, rad; 0 without contact.
    pub fn contact_bends_rad(&self) -> PerSegment<f64> {
        self.curves.iter().map(|curve| curve.touch.bend_rad).collect()
    }

    /// The pushes of scenario II that have begun, oldest first; none in the other scenarios.
    pub fn pushes(&self) -> &[Push] {
        self.contacts.pushes()
    }
}

/// Right and left value of the module that a segment belongs to.
fn of_segment(regulators: &[f64], segment: usize) -> [f64; 2] {
    let right = 2 * (segment / SEGMENTS_PER_MODULE);
    [regulators[right], regulators[right + 1]]
}
