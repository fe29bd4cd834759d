//! Sessions of the twin in memory, and their replay in the board's fixed point.

use std::convert::Infallible;

use calibration_tables::{ArmFile, FileError, MAX_SEGMENTS};
use estimator_core::{ArmConfig, Estimator, ImuReading, Q, Sample};
use proprio_analysis::smooth::{ForwardPass, SmoothingPass};
use proprio_analysis::{HostEstimator, Outcome};
use proprio_session::{Row, Truth};
use proprio_simulation::{Recorded, Simulation, SimulationError};
use rig_twin::{PerSegment, Push, Setup};

/// A session of the twin.
#[derive(Debug, Clone)]
pub struct TwinSession {
    /// Samples a second.
    pub rate_hz: f64,
    /// Readings and truth.
    pub samples: Vec<Recorded>,
    /// Bend angle that contact adds to each segment, rad; one value a sample.
    pub contact_bends_rad: Vec<PerSegment<f64>>,
    /// Pushes of scenario II.
    pub pushes: Vec<Push>,
}

impl TwinSession {
    /// Simulates `seconds` of a session at `rate_hz`.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn new(setup: &Setup, seconds: f64, rate_hz: f64) -> Result<Self, SimulationError> {
        Ok(Self::of(Simulation::of(setup, seconds, rate_hz)?, rate_hz))
    }

    /// The session of a simulation that samples at `rate_hz`.
    pub fn of(mut simulation: Simulation, rate_hz: f64) -> Self {
        let (mut samples, mut contact_bends_rad) = (Vec::new(), Vec::new());
        while let Some(sample) = simulation.next() {
            samples.push(sample);
            contact_bends_rad.push(simulation.rig().contact_bends_rad());
        }
        Self { rate_hz, samples, contact_bends_rad, pushes: simulation.rig().pushes().to_vec() }
    }

    /// Index of the first sample at or after `time_s`.
    #[must_use]
    pub fn index(&self, time_s: f64) -> usize {
        self.samples.partition_point(|sample| (sample.time_us as f64) < time_s * 1e6)
    }

    /// The rows, as a session's file would have them.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        self.samples.iter().enumerate().map(|(k, sample)| row(sample, k == 0))
    }

    /// Replays the session; `visit` receives what [`replay`] gives it.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay(&self, table: &ArmFile, visit: impl FnMut(&Row, &Outcome<Q>)) -> Result<(), FileError> {
        replay(table, self.rate_hz, self.rows(), visit)
    }
}

/// The row of a sample of the twin, as a session's file would have it.
#[must_use]
pub fn row(recorded: &Recorded, starts: bool) -> Row {
    let mut sample = Sample::missing(recorded.time_us);
    let mut truth = [None; MAX_SEGMENTS];
    for (i, counts) in recorded.counts.iter().copied().enumerate() {
        sample.bend[i / 2][i % 2] = counts;
    }
    for (imu, quaternion) in sample.imu.iter_mut().zip(&recorded.quaternions) {
        *imu = quaternion.map(ImuReading::from_bno055);
    }
    for (truth, end) in truth.iter_mut().zip(&recorded.truth) {
        *truth = Some(Truth { x_m: end.x_m, y_m: end.y_m, heading_rad: Some(end.heading_rad) });
    }
    Row { sample, truth, starts, board: None }
}

/// The estimator in the board's fixed point, row by row.
pub struct Replayer<'t> {
    estimator: Box<HostEstimator<'t, Q>>,
}

impl<'t> Replayer<'t> {
    /// An estimator at the start of a session.
    ///
    /// # Panics
    /// If the arm has more segments than the estimator; tables from files do not.
    #[must_use]
    pub fn new(config: &'t ArmConfig<'t, Q>) -> Self {
        Self { estimator: Box::new(Estimator::new(config).expect("the file was checked")) }
    }

    /// Processes a row.
    ///
    /// # Panics
    /// As [`Self::new`].
    pub fn step(&mut self, row: &Row) -> Outcome<Q> {
        Outcome::of_row(&mut self.estimator, row)
    }
}

/// Replays rows sampled at `rate_hz`; `visit` receives every row with its outcome.
///
/// # Errors
/// [`FileError`] if the file is not a table.
pub fn replay(
    table: &ArmFile,
    rate_hz: f64,
    rows: impl Iterator<Item = Row>,
    mut visit: impl FnMut(&Row, &Outcome<Q>),
) -> Result<(), FileError> {
    let compiled = table.compile::<Q>(rate_hz)?;
    let config = compiled.config();
    let mut replayer = Replayer::new(&config);
    for row in rows {
        visit(&row, &replayer.step(&row));
    }
    Ok(())
}

/// Replays rows sampled at `rate_hz` and smooths them; `visit` receives every row with its outcome.
///
/// # Errors
/// [`FileError`] if the file is not a table.
pub fn replay_smoothed<R: Iterator<Item = Row>>(
    table: &ArmFile,
    rate_hz: f64,
    rows: impl Fn() -> R,
    mut visit: impl FnMut(&Row, &Outcome<Q>),
) -> Result<(), FileError> {
    let compiled = table.compile::<Q>(rate_hz)?;
    let config = compiled.config();
    let mut forward = ForwardPass::new(&config);
    rows().for_each(|row| forward.add(&row));
    let mut smoothing = SmoothingPass::new(&config, forward.finish());
    let mut visit = |row: &Row, outcome: &Outcome<Q>| -> Result<(), Infallible> {
        visit(row, outcome);
        Ok(())
    };
    for row in rows() {
        let Ok(()) = smoothing.add(&row, &mut visit);
    }
    let Ok(()) = smoothing.finish(&mut visit);
    Ok(())
}
