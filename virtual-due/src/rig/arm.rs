//! The simulated arm in virtual time, and the pins that command its pressure regulators.

use rig_twin::{MotionProgram, REGULATORS, Rig as Twin, Scenario};
use sam3x_models::model::Cycles;

/// The twin's own grid, s and cycles.
const GRID_S: f64 = 0.002;
const GRID: Cycles = 168_000;

/// Pressure of a regulator at full duty, Pa (supply pressure of the reference rig).
const FULL_SCALE_PA: f64 = 280_000.0;

/// State of a regulator's pin.
#[derive(Debug, Clone, Copy, Default)]
struct SetPoint {
    /// The level that PIO drives.
    driven: Option<bool>,
    /// High clocks, and clocks of the period, of the PWM.
    pulsed: Option<(u32, u32)>,
}

impl SetPoint {
    /// Duty, 0 … 1; a pin that nothing drives vents.
    fn duty(self) -> f64 {
        match (self.driven, self.pulsed) {
            (Some(level), _) => f64::from(u8::from(level)),
            (None, Some((high, period))) if period != 0 => (f64::from(high) / f64::from(period)).min(1.0),
            _ => 0.0,
        }
    }
}

/// The arm, its regulators, and the source of their set-points.
#[derive(Debug, Clone)]
pub struct DrivenArm {
    twin: Twin,
    program: MotionProgram,
    grid_points: u64,
    set_points: [SetPoint; REGULATORS],
    /// No regulator pin was ever driven: the scenario's program moves the arm, as a bench supply would.
    on_bench_supply: bool,
}

impl DrivenArm {
    /// At rest, at time 0.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        Self {
            twin: Twin::new(scenario, seed),
            program: MotionProgram::new(scenario, seed),
            grid_points: 0,
            set_points: [SetPoint::default(); REGULATORS],
            on_bench_supply: true,
        }
    }

    /// Advances the arm to the last grid point at or before `now`; an earlier time changes nothing.
    pub fn advance_to(&mut self, now: Cycles) {
        while (self.grid_points + 1) * GRID <= now {
            self.twin.step(GRID_S, self.duties());
            self.grid_points += 1;
        }
    }

    /// Present set-points of the regulators, 0 … 1.
    fn duties(&self) -> [f64; REGULATORS] {
        if self.on_bench_supply {
            self.program.duties(self.grid_points as f64 * GRID_S)
        } else {
            self.set_points.map(SetPoint::duty)
        }
    }

    /// The same in Pa.
    pub fn set_points_pa(&self) -> [f64; REGULATORS] {
        self.duties().map(|duty| duty * FULL_SCALE_PA)
    }

    /// PIO drives a regulator's pin, or no longer does.
    pub fn drive(&mut self, regulator: usize, level: Option<bool>) {
        self.on_bench_supply &= level.is_none();
        self.set_points[regulator].driven = level;
    }

    /// The PWM drives a regulator's pin, or no longer does.
    pub fn pulse(&mut self, regulator: usize, duty: Option<(u32, u32)>) {
        self.on_bench_supply &= duty.is_none();
        self.set_points[regulator].pulsed = duty;
    }

    /// The twin.
    pub fn twin(&self) -> &Twin {
        &self.twin
    }

    /// A conversion of a bend sensor.
    pub fn convert(&mut self, sensor: usize) -> u16 {
        self.twin.convert(sensor)
    }
}
