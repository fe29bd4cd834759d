//! Driver of a board's pressures: the board stays armed while the driver exists.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use telemetry::{Command, Health, SetPressures};

use super::DriveError;
use crate::status::Status;
use crate::{EventKind, Link, LinkError, RequestError};

/// Time from one set of pressures to the next.
pub const PERIOD: Duration = Duration::from_millis(50);

/// Time for which the board holds them, ms: a lost request is repeated twice until then.
pub const VALID_MS: u16 = 300;

/// Longest time from a board's first reply to its first `Hello`.
const FIRST_HELLO: Duration = Duration::from_millis(200);

/// Number of set-points that are stored: those of the second before a `Health`.
const STORED: usize = 20;

/// Tolerance of a set-point for rounding, Pa.
const TOLERANCE_PA: u32 = 1000;

/// Drives the pressures; vents them when it is dropped.
#[derive(Debug)]
pub struct Driver<'l> {
    link: &'l Link,
    requested_pa: VecDeque<Vec<u32>>,
    is_armed: bool,
    /// Restarts of the board when it was armed.
    restarts: u32,
}

impl<'l> Driver<'l> {
    /// Arms the pressures of a board without faults that has so many regulators.
    ///
    /// # Errors
    /// [`DriveError`]: the board has another number of regulators or another table, has restarted after a crash, reads no IMU, or
    /// refuses; another handle of the link drives it.
    pub fn arm(link: &'l Link, status: &Status, regulators: usize) -> Result<Self, DriveError> {
        check(link, status, regulators)?;
        let mut driver = Self { link, requested_pa: VecDeque::new(), is_armed: true, restarts: link.state().restarts };
        let armed = link.request(Command::Arm);
        // Another program's arm is not vented.
        driver.is_armed = !matches!(armed, Err(LinkError::Request(RequestError::Driven)));
        armed?;
        Ok(driver)
    }

    /// Sets the pressures of all regulators, Pa, waits until the board has acknowledged them, and returns the request.
    ///
    /// # Errors
    /// [`DriveError::Restarted`], after which the board is not armed; [`DriveError::Lost`]; [`DriveError::Link`].
    pub fn set(&mut self, pressures_pa: Vec<u32>) -> Result<SetPressures, DriveError> {
        let requested = SetPressures { pressures_pa: pressures_pa.iter().copied().collect(), valid_ms: VALID_MS };
        self.link.request(Command::SetPressures(requested.clone())).map_err(|error| self.cause_of(error))?;
        if self.requested_pa.len() == STORED {
            self.requested_pa.pop_front();
        }
        self.requested_pa.push_back(pressures_pa);
        Ok(requested)
    }

    /// The cause of a failed request, where there is one behind it: the board has restarted since it was armed, or its line is
    /// gone. The board replies to a request before its first `Hello`, which shows the restart.
    fn cause_of(&self, error: LinkError) -> DriveError {
        let (start, events) = (Instant::now(), self.link.subscribe());
        while self.link.state().restarts == self.restarts {
            // The state changes with the events.
            match events.next(Duration::from_millis(10)).map(|event| event.kind) {
                Some(EventKind::Lost(reason) | EventKind::Ended(reason)) => return DriveError::Lost(reason),
                _ if start.elapsed() >= FIRST_HELLO => return error.into(),
                _ => {}
            }
        }
        DriveError::Restarted
    }

    /// Checks that the board follows the requested pressures.
    ///
    /// # Errors
    /// [`DriveError::HeldBack`] where its pressures are below all that were requested within the last second.
    pub fn check(&self, health: &Health) -> Result<(), DriveError> {
        if self.requested_pa.len() < STORED {
            return Ok(());
        }
        for (i, board_pa) in health.pressures_pa.iter().enumerate() {
            let requested_pa =
                self.requested_pa.iter().filter_map(|pressures_pa| pressures_pa.get(i)).min().unwrap_or(&0);
            if board_pa + TOLERANCE_PA < *requested_pa {
                let [board_kpa, requested_kpa] = [*board_pa, *requested_pa].map(|pa| f64::from(pa) / 1e3);
                return Err(DriveError::HeldBack { regulator: i + 1, board_kpa, requested_kpa });
            }
        }
        Ok(())
    }

    /// Vents the pressures and waits until the board has acknowledged that.
    ///
    /// # Errors
    /// [`LinkError::Request`]; the board vents at its own deadline, within 1.5 s, even so.
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

/// Checks that the board may be driven by pressures of so many regulators.
fn check(link: &Link, status: &Status, regulators: usize) -> Result<(), DriveError> {
    let board = usize::from(status.hello.regulators);
    if regulators != board {
        return Err(DriveError::Regulators { given: regulators, board });
    }
    let mismatches = link.state().mismatches;
    if let Some(table) = mismatches.iter().find(|mismatch| mismatch.is_table()) {
        return Err(DriveError::OtherTable(table.to_string()));
    }
    if let Some(panic) = &status.hello.last_panic {
        return Err(DriveError::Crashed(panic.as_str().to_owned()));
    }
    // The firmware raises no pressure without a valid IMU. Its other reasons to refuse show when it is driven.
    if status.health.imu.iter().all(|imu| !imu.state.is_usable()) {
        return Err(DriveError::Blind);
    }
    Ok(())
}
