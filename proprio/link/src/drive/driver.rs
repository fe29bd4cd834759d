//! A board that is being driven: armed as long as this lives.

use std::collections::VecDeque;
use std::time::Duration;

use telemetry::{Command, Health, REGULATORS, SensorState, SetPressures};

use super::DriveError;
use crate::status::Status;
use crate::{Link, LinkError, Mismatch};

/// Time from one set of pressures to the next.
pub const PERIOD: Duration = Duration::from_millis(50);

/// How long the board lets them stand, ms: a lost request is repeated twice until then.
pub const VALID_MS: u16 = 300;

/// Set-points that are remembered, for the second before a `Health`.
const REMEMBERED: usize = 20;

/// Less than that is rounding, Pa.
const TOLERANCE_PA: u32 = 1000;

/// Drives the pressures. Dropped, it vents them.
#[derive(Debug)]
pub struct Driver<'l> {
    link: &'l Link,
    asked_pa: VecDeque<[u32; REGULATORS]>,
    is_armed: bool,
}

impl<'l> Driver<'l> {
    /// Arms the pressures of a board that is well.
    ///
    /// # Errors
    /// [`DriveError`]: the board has another table, comes out of a crash, is blind, or refuses.
    pub fn arm(link: &'l Link, status: &Status) -> Result<Self, DriveError> {
        check(link, status)?;
        let driver = Self { link, asked_pa: VecDeque::new(), is_armed: true };
        link.request(Command::Arm)?;
        Ok(driver)
    }

    /// Sets the pressures, Pa, waits until that is done, and gives what was asked.
    ///
    /// # Errors
    /// [`LinkError::Request`].
    pub fn set(&mut self, pressures_pa: [u32; REGULATORS]) -> Result<SetPressures, LinkError> {
        let asked = SetPressures { pressures_pa, valid_ms: VALID_MS };
        self.link.request(Command::SetPressures(asked))?;
        if self.asked_pa.len() == REMEMBERED {
            self.asked_pa.pop_front();
        }
        self.asked_pa.push_back(pressures_pa);
        Ok(asked)
    }

    /// Whether the board does what it was asked for.
    ///
    /// # Errors
    /// [`DriveError::HeldBack`] where its pressures are below all that were asked for within the last second.
    pub fn check(&self, health: &Health) -> Result<(), DriveError> {
        if self.asked_pa.len() < REMEMBERED {
            return Ok(());
        }
        for (i, board_pa) in health.pressures_pa.iter().enumerate() {
            let asked_pa = self.asked_pa.iter().map(|pressures_pa| pressures_pa[i]).min().unwrap_or(0);
            if board_pa + TOLERANCE_PA < asked_pa {
                let [board_kpa, asked_kpa] = [*board_pa, asked_pa].map(|pa| f64::from(pa) / 1e3);
                return Err(DriveError::HeldBack { regulator: i + 1, board_kpa, asked_kpa });
            }
        }
        Ok(())
    }

    /// Vents the pressures and waits until that is done.
    ///
    /// # Errors
    /// [`LinkError::Request`]; the board vents by itself within 1.5 s all the same.
    pub fn vent(mut self) -> Result<(), LinkError> {
        self.is_armed = false;
        self.link.request(Command::Disarm)
    }
}

impl Drop for Driver<'_> {
    fn drop(&mut self) {
        if self.is_armed {
            // If it does not arrive, the board's own deadline vents.
            let _ = self.link.request(Command::Disarm);
        }
    }
}

/// Whether the board may be driven.
fn check(link: &Link, status: &Status) -> Result<(), DriveError> {
    let mismatches = link.state().mismatches;
    if let Some(table) = mismatches.iter().find(|mismatch| matches!(mismatch, Mismatch::Table { .. })) {
        return Err(DriveError::OtherTable(table.to_string()));
    }
    if let Some(panic) = &status.hello.last_panic {
        return Err(DriveError::Crashed(panic.as_str().to_owned()));
    }
    // The firmware lets no pressure rise then; other reasons of its own show once it is driven.
    if status.health.imu.iter().all(|imu| imu.state != SensorState::Ok) {
        return Err(DriveError::Blind);
    }
    Ok(())
}
