//! The twin as a rig that is recorded: its own duty programme, sampled at a fixed rate.

use proprio_session::check_seconds;
use rig_twin::{
    Camera, EndPose, Frame, HeadingDrift, MotionProgram, PerBendSensor, PerSegment, Rig, Scenario, Setup, TimedFault,
};

use crate::error::SimulationError;

/// The regulators get a new duty at least this often, s: the firmware's tick.
const TICK_S: f64 = 0.01;

/// One recorded sample.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Time since the start, µs.
    pub time_us: u64,
    /// ADC counts of bend sensors 1a, 1b, 2a, …; `None`: not read, or no such sensor.
    pub counts: PerBendSensor<Option<u16>>,
    /// Quaternion registers w, x, y, z of each IMU, units of 2⁻¹⁴; `None`: not read, or no such IMU.
    pub quaternions: PerSegment<Option<[i16; 4]>>,
    /// True pose of each segment's end.
    pub truth: PerSegment<EndPose>,
}

impl Recorded {
    /// The same sample with a drift added to each IMU's heading.
    #[must_use]
    pub fn with_drift(mut self, drifts: &[HeadingDrift]) -> Self {
        let time_s = self.time_us as f64 / 1e6;
        for (quaternion, drift) in self.quaternions.iter_mut().zip(drifts) {
            *quaternion = quaternion.map(|quaternion| drift.turn(time_s, quaternion));
        }
        self
    }
}

/// A run of the twin, one [`Recorded`] after the other.
pub struct Simulation {
    rig: Rig,
    program: MotionProgram,
    rate_hz: f64,
    samples: u64,
    next: u64,
    /// When the duties stop to change, and for how long, s.
    pause: Option<(f64, f64)>,
    camera: Option<Camera>,
    frames: Vec<Frame>,
}

impl Simulation {
    /// `seconds` of a scenario on the reference arm, sampled at `rate_hz`. The seed determines the motion and all noise.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn new(scenario: Scenario, seed: u64, seconds: f64, rate_hz: f64) -> Result<Self, SimulationError> {
        Self::of(&Setup::new(scenario, seed), seconds, rate_hz)
    }

    /// `seconds` of a session, sampled at `rate_hz`.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn of(setup: &Setup, seconds: f64, rate_hz: f64) -> Result<Self, SimulationError> {
        if !(1.0..=1000.0).contains(&rate_hz) {
            return Err(SimulationError::Rate(rate_hz));
        }
        check_seconds(seconds)?;
        let samples = (seconds * rate_hz).round().max(1.0) as u64;
        let (rig, program) = (Rig::of(setup), MotionProgram::of(setup));
        Ok(Self { rig, program, rate_hz, samples, next: 0, pause: None, camera: None, frames: Vec::new() })
    }

    /// The same run under a camera; the arm and its sensors stay the same to the bit.
    #[must_use]
    pub fn under(self, camera: Camera) -> Self {
        Self { camera: Some(camera), ..self }
    }

    /// The same run with a rest: from `at_s` on the duties hold for `for_s` seconds, then the motion continues.
    #[must_use]
    pub fn with_rest(self, at_s: f64, for_s: f64) -> Self {
        Self { pause: Some((at_s, for_s)), ..self }
    }

    /// The same run with a fault of a sensor.
    ///
    /// # Errors
    /// [`SimulationError::Fault`] if the arm does not have the sensor, or the fault is none of a sensor's readings.
    pub fn with_fault(mut self, fault: TimedFault) -> Result<Self, SimulationError> {
        self.rig.inject(fault)?;
        Ok(self)
    }

    /// The rig at the newest sample.
    #[must_use]
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// Takes the camera's frames up to the last sample since the last call.
    pub fn take_frames(&mut self) -> Vec<Frame> {
        std::mem::take(&mut self.frames)
    }

    /// Number of samples of the whole run.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    fn time_s(&self, sample: u64) -> f64 {
        sample as f64 / self.rate_hz
    }

    fn advance(&mut self, to_s: f64) {
        let from_s = self.rig.time_s();
        let ticks = ((to_s - from_s) / TICK_S - 1e-6).ceil().max(1.0);
        for k in 0..ticks as u32 {
            let dt_s = (to_s - from_s) / ticks;
            let duties = self.program.duties(self.program_s(from_s + f64::from(k) * dt_s));
            self.step(dt_s, &duties);
        }
    }

    /// Time of the motion at a time of the session.
    fn program_s(&self, time_s: f64) -> f64 {
        match self.pause {
            Some((at_s, for_s)) if time_s > at_s => at_s.max(time_s - for_s),
            _ => time_s,
        }
    }

    /// Lets time pass, with a stop at every frame in it.
    fn step(&mut self, mut dt_s: f64, duties: &[f64]) {
        if let Some(camera) = &mut self.camera {
            let mut to_frame_s = camera.next_s() - self.rig.time_s();
            while to_frame_s < dt_s {
                self.rig.step(to_frame_s, duties);
                self.frames.extend(camera.take(&self.rig.truth()));
                dt_s -= to_frame_s.max(0.0);
                to_frame_s = camera.next_s() - self.rig.time_s();
            }
        }
        self.rig.step(dt_s, duties);
    }
}

impl Iterator for Simulation {
    type Item = Recorded;

    fn next(&mut self) -> Option<Recorded> {
        if self.next == self.samples {
            return None;
        }
        let time_s = self.time_s(self.next);
        if self.next > 0 {
            self.advance(time_s);
        }
        self.next += 1;
        Some(Recorded {
            time_us: (time_s * 1e6).round() as u64,
            counts: self.rig.adc_counts(),
            quaternions: self.rig.imu_quaternions(),
            truth: self.rig.truth(),
        })
    }
}
