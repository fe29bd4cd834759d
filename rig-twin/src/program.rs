//! Programs of motion: the regulators' duties over time in a scenario.

use crate::constants::{
    CONTACT_DRIVE, CONTACT_PERIODS_S, ENVELOPE, ENVELOPE_PERIODS, FADE_IN_S, FREE_DRIVE, FREE_PERIODS_S, FULL_BEND_RAD,
    OBSTACLE_LEAN_DRIVE, PACE_PERIODS, PACE_RAD, REST_S, SEGMENTS_PER_MODULE, START_DRIVE, SWEEP_DRIVE,
    SWEEP_PERIODS_S, TOTAL_HEADING_RAD,
};
use crate::contact::Obstacle;
use crate::layout::{Layout, PerModule, PerRegulator};
use crate::motion::{Motion, Pauses, leaning_pose, still};
use crate::noise::{Noise, Source};
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::smooth_step::smooth_step;
use core::f64::consts::TAU;

/// The motion of a session: duties of the regulators over time.
#[derive(Clone, Debug)]
pub struct MotionProgram {
    motion: Motion,
    layout: Layout,
    swings: PerModule<Swing>,
    heading_limit_rad: f64,
    pauses: Option<Pauses>,
    /// Drive of each module before the first swing, a share of full pressure.
    start_pose: PerModule<f64>,
}

impl MotionProgram {
    /// The motion of `scenario` in the session of `seed` on the reference arm.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        Self::of(&Setup::new(scenario, seed))
    }

    /// The motion of a session.
    pub fn of(setup: &Setup) -> Self {
        let (scenario, seeds) = (setup.scenario, setup.seeds());
        let (drive, periods_s) = match scenario {
            Scenario::Sweep => (SWEEP_DRIVE, SWEEP_PERIODS_S),
            Scenario::FreeSwing => (FREE_DRIVE, FREE_PERIODS_S),
            Scenario::Push | Scenario::Obstacle => (CONTACT_DRIVE, CONTACT_PERIODS_S),
        };
        let periods_s = (setup.motion.periods() * periods_s.0, setup.motion.periods() * periods_s.1);
        let side = if scenario == Scenario::Obstacle { Obstacle::new(&setup.layout, seeds).side } else { 0.0 };
        let modules = setup.layout.modules();
        let mut schedule = Noise::of_session(seeds, Source::Schedule, 0);
        let moving = (setup.motion == Motion::OneModule).then(|| schedule.pick(modules));
        let heading_limit_rad = if scenario == Scenario::Sweep { f64::INFINITY } else { TOTAL_HEADING_RAD };
        let swing = |module| {
            let lean = if module + 1 < modules { OBSTACLE_LEAN_DRIVE * side } else { 0.0 };
            let drive = if moving.is_none_or(|moving| moving == module) { drive } else { 0.0 };
            Swing::new(drive, lean, periods_s, &mut Noise::of_session(seeds, Source::Motion, module))
        };
        let is_bent = setup.motion == Motion::BentStart;
        Self {
            motion: setup.motion,
            layout: setup.layout.clone(),
            swings: (0..modules).map(swing).collect(),
            heading_limit_rad,
            pauses: Pauses::new(setup.motion, modules, side, &mut schedule),
            start_pose: if is_bent { leaning_pose(modules, START_DRIVE, side, &mut schedule) } else { still(modules) },
        }
    }

    /// Duties of the regulators at `t_s` seconds, each 0 … 1: module 1 right, left, module 2 right, left, …
    pub fn duties(&self, t_s: f64) -> PerRegulator<f64> {
        if !t_s.is_finite() || (self.motion.starts_at_rest() && t_s <= REST_S) {
            return (0..self.layout.regulators()).map(|_| 0.0).collect();
        }
        let drives = self.drives(t_s);
        let turns = drives.iter().enumerate().map(|(module, drive)| drive * self.layout.share_of_module(module));
        let heading_rad = turns.sum::<f64>() * FULL_BEND_RAD * SEGMENTS_PER_MODULE as f64;
        let excess = heading_rad / self.heading_limit_rad;
        let share = 1.0 / libm::sqrt(libm::sqrt(1.0 + excess * excess * excess * excess));
        let of_module = |drive: f64| [(share * drive).max(0.0), (-(share * drive)).max(0.0)];
        drives.into_iter().flat_map(of_module).collect()
    }

    /// Right minus left of each module at `t_s`, a share of full pressure, before the heading is limited.
    fn drives(&self, t_s: f64) -> PerModule<f64> {
        let is_moving = self.motion == Motion::MovingStart;
        let fade = if is_moving { 1.0 } else { smooth_step((t_s - REST_S) / FADE_IN_S) };
        let modules = self.swings.iter().zip(&self.start_pose);
        let drives = modules.map(|(swing, start)| fade * swing.drive(t_s) + (1.0 - fade) * start);
        let drives: PerModule<f64> = drives.collect();
        match &self.pauses {
            Some(pauses) => pauses.interrupt(t_s - REST_S, drives),
            None => drives,
        }
    }
}

/// A module's swing: a sine whose size and pace vary slowly, so that it visits its whole range from both sides.
#[derive(Clone, Debug)]
struct Swing {
    drive: f64,
    lean: f64,
    carrier: Wave,
    envelope: Wave,
    pace: Wave,
}

impl Swing {
    fn new(drive: f64, lean: f64, periods_s: (f64, f64), noise: &mut Noise) -> Self {
        let period_s = noise.between(periods_s);
        Self {
            drive,
            lean,
            carrier: Wave::new(period_s, noise),
            envelope: Wave::new(period_s * noise.between(ENVELOPE_PERIODS), noise),
            pace: Wave::new(period_s * noise.between(PACE_PERIODS), noise),
        }
    }

    /// Right minus left at `t_s`, a share of full pressure.
    fn drive(&self, t_s: f64) -> f64 {
        let (mean, swing) = ENVELOPE;
        let envelope = mean + swing * libm::sin(self.envelope.phase_rad(t_s));
        let pace_rad = PACE_RAD * libm::sin(self.pace.phase_rad(t_s));
        self.lean + self.drive * envelope * libm::sin(self.carrier.phase_rad(t_s) + pace_rad)
    }
}

#[derive(Clone, Debug)]
struct Wave {
    rate_rad_per_s: f64,
    start_rad: f64,
}

impl Wave {
    fn new(period_s: f64, noise: &mut Noise) -> Self {
        Self { rate_rad_per_s: TAU / period_s, start_rad: noise.between((0.0, TAU)) }
    }

    fn phase_rad(&self, t_s: f64) -> f64 {
        self.rate_rad_per_s * t_s + self.start_rad
    }
}
