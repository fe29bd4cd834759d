//! What is measured of a fault: times of events, and the tip's distance from the truth.

use std::sync::OnceLock;

use telemetry::{Event, SensorState};

use crate::trial::Trial;

/// Seed of the sessions.
const SEED: u64 = 1;

/// Time for which the arm swings before the fault, s.
const BEFORE_S: u64 = 15;

/// Time after the fault that the session without faults covers, ms.
const AFTER_MS: u64 = 12_000;

/// Error of the tip that a fault may add, mm: 2 % of the arm's length.
pub(crate) const ADDED_MM: f64 = 12.0;

/// A fault, its promise, and what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The fault.
    pub row: &'static str,
    /// Names of what was injected.
    pub injected: &'static str,
    /// The promise.
    pub promise: &'static str,
    /// Times and distances.
    pub measured: String,
    /// True if they keep the promise.
    pub holds: bool,
}

/// Runs the trial of a row.
pub type Row = fn() -> Measured;

/// A board whose arm has swung for [`BEFORE_S`].
pub(super) fn swinging() -> Trial {
    Trial::swinging(SEED, BEFORE_S)
}

/// A board whose arm has moved for [`BEFORE_S`] at a twelfth of that speed.
pub(super) fn slow() -> Trial {
    Trial::at_pace(SEED, BEFORE_S, 1.0 / 12.0)
}

/// A board whose arm has swung for [`BEFORE_S`], and has swung on with these faults for some time, ms.
pub(super) fn with(faults: &str, ms: u64) -> Trial {
    let mut trial = swinging();
    faults.split(' ').for_each(|fault| trial.inject(fault));
    trial.run_ms(ms);
    trial
}

/// The same session without a fault.
fn without() -> &'static (f64, f64) {
    static LARGEST: OnceLock<(f64, f64)> = OnceLock::new();
    LARGEST.get_or_init(|| {
        let mut trial = swinging();
        trial.mark();
        trial.run_ms(AFTER_MS);
        let window = (0.0, AFTER_MS as f64);
        (trial.largest_tip_error_mm(window.0, window.1), trial.largest_step_mm(window.0, window.1))
    })
}

/// The tip from one time after the fault to another: text, and whether the fault adds no more than [`ADDED_MM`].
pub(super) fn tip(trial: &Trial, from_ms: f64, to_ms: f64) -> (String, bool) {
    let (good_mm, good_step_mm) = without();
    let largest_mm = trial.largest_tip_error_mm(from_ms, to_ms);
    let step_mm = trial.largest_step_mm(from_ms, to_ms);
    let text = format!(
        "tip off by {largest_mm:.1} mm at most, steps of {step_mm:.1} mm, from {:.2} s to {:.0} s (without the fault \
         {good_mm:.1} and {good_step_mm:.1} mm)",
        from_ms / 1e3,
        to_ms / 1e3
    );
    (text, largest_mm <= good_mm + ADDED_MM && step_mm <= good_step_mm + ADDED_MM)
}

/// Time of the first event that reports a bend sensor as not ok, ms.
pub(super) fn bend_noticed_ms(trial: &Trial, sensor: u8) -> Option<f64> {
    trial.noticed_ms(|event| matches!(event, Event::Bend(index, state) if index == sensor && state != SensorState::Ok))
}

/// Time of the first event that reports an IMU as not ok, ms.
pub(super) fn imu_noticed_ms(trial: &Trial, imu: u8) -> Option<f64> {
    trial.noticed_ms(|event| matches!(event, Event::Imu(index, state) if index == imu && state != SensorState::Ok))
}

/// Time of the first event that reports an IMU as ok, ms.
pub(super) fn imu_back_ms(trial: &Trial, imu: u8) -> Option<f64> {
    trial.noticed_ms(|event| event == Event::Imu(imu, SensorState::Ok))
}

/// A time for people.
pub(super) fn text_of(ms: Option<f64>) -> String {
    ms.map_or("never".to_owned(), |ms| format!("{ms:.1} ms"))
}

/// True if the time is there and within a limit.
pub(super) fn within(ms: Option<f64>, limit_ms: f64) -> bool {
    ms.is_some_and(|ms| ms <= limit_ms)
}
