//! The simulated arm in virtual time, and the pins that command its pressure regulators.

use board_table::{REFERENCE_FULL_SCALE_PA, RegulatorWiring, Wiring};
use rig_twin::{MotionProgram, PerRegulator, Rig as Twin, Setup};
use sam3x_models::model::Cycles;

/// The twin's own grid, s and cycles.
const GRID_S: f64 = 0.002;
const GRID: Cycles = 168_000;

/// Pressure of the twin's supply, which its regulators have at full duty, Pa.
const SUPPLY_PA: f64 = REFERENCE_FULL_SCALE_PA as f64;

/// State of a regulator's pin.
#[derive(Debug, Clone, Copy)]
struct SetPoint {
    /// Pressure at full duty, Pa.
    full_scale_pa: f64,
    /// The level that PIO drives.
    driven: Option<bool>,
    /// High clocks, and clocks of the period, of the PWM.
    pulsed: Option<(u32, u32)>,
}

impl SetPoint {
    fn new(wired: RegulatorWiring) -> Self {
        Self { full_scale_pa: f64::from(wired.full_scale_pa), driven: None, pulsed: None }
    }

    /// Duty, 0 … 1; a pin that nothing drives vents.
    fn duty(self) -> f64 {
        match (self.driven, self.pulsed) {
            (Some(level), _) => f64::from(u8::from(level)),
            (None, Some((high, period))) if period != 0 => (f64::from(high) / f64::from(period)).min(1.0),
            _ => 0.0,
        }
    }

    /// The pressure that the pin commands, Pa.
    fn pressure_pa(self) -> f64 {
        self.duty() * self.full_scale_pa
    }
}

/// The arm, its regulators, and the source of their set-points.
#[derive(Debug, Clone)]
pub struct DrivenArm {
    twin: Twin,
    program: MotionProgram,
    grid_points: u64,
    set_points: PerRegulator<SetPoint>,
    /// No regulator pin was ever driven: the scenario's program moves the arm, as a bench supply would.
    on_bench_supply: bool,
}

impl DrivenArm {
    /// At rest, at time 0.
    pub fn new(setup: &Setup, wiring: &Wiring) -> Self {
        Self {
            twin: Twin::of(setup),
            program: MotionProgram::of(setup),
            grid_points: 0,
            set_points: wiring.regulators.iter().copied().map(SetPoint::new).collect(),
            on_bench_supply: true,
        }
    }

    /// Advances the arm to the last grid point at or before `now`; an earlier time changes nothing.
    pub fn advance_to(&mut self, now: Cycles) {
        while (self.grid_points + 1) * GRID <= now {
            self.twin.step(GRID_S, &self.duties());
            self.grid_points += 1;
        }
    }

    /// Present set-points of the twin's regulators, 0 … 1; a pressure above the supply's counts as that.
    fn duties(&self) -> PerRegulator<f64> {
        if self.on_bench_supply {
            self.program.duties(self.grid_points as f64 * GRID_S)
        } else {
            self.set_points.iter().map(|set_point| set_point.duty() * (set_point.full_scale_pa / SUPPLY_PA)).collect()
        }
    }

    /// Present set-points of the wired regulators, Pa.
    pub fn set_points_pa(&self) -> PerRegulator<f64> {
        if self.on_bench_supply {
            let duties = self.duties().into_iter().chain(std::iter::repeat(0.0));
            duties.take(self.set_points.len()).map(|duty| duty * SUPPLY_PA).collect()
        } else {
            self.set_points.iter().map(|set_point| set_point.pressure_pa()).collect()
        }
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

    /// The twin, for faults of its sensors.
    pub fn twin_mut(&mut self) -> &mut Twin {
        &mut self.twin
    }

    /// A conversion of a bend sensor; `None`: the arm does not have it.
    pub fn convert(&mut self, sensor: usize) -> Option<u16> {
        self.twin.convert(sensor)
    }
}
