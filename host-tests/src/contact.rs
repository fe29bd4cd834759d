//! Contact as the estimator detects it, compared with the simulated arm's contacts.

use std::error::Error;
use std::ops::AddAssign;

use calibration_tables::ArmFile;
use proprio_analysis::Outcome;
use rig_twin::{PerSegment, Push, SEGMENTS, Scenario, Setup};

use crate::twin::TwinSession;

/// Rate of the estimator's samples, Hz.
const RATE_HZ: f64 = 10.0;
/// Bend of a segment from which a contact has to be detected, rad.
const STRONG_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Time within which it has to be detected, s.
const SOON_S: f64 = 0.5;

/// A run, sample by sample and segment by segment.
pub struct ContactSession {
    /// True if the estimator reports contact of the segment.
    pub detected: Vec<[bool; SEGMENTS]>,
    /// Bend angle that contact adds to the segment, rad.
    pub bends_rad: Vec<PerSegment<f64>>,
    pushes: Vec<Push>,
}

/// Number of contacts, and of those that were detected.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Found {
    /// Detected ones.
    pub found: usize,
    /// All.
    pub all: usize,
}

/// Segments of the twin that are in contact by an outcome.
#[must_use]
pub fn in_contact<S>(outcome: &Outcome<S>) -> [bool; SEGMENTS] {
    std::array::from_fn(|i| outcome.contacts.get(i).is_some_and(|contact| contact.in_contact))
}

impl AddAssign for Found {
    fn add_assign(&mut self, other: Self) {
        *self = Self { found: self.found + other.found, all: self.all + other.all };
    }
}

/// Number of contacts that begin; of a free arm, of false alarms.
#[must_use]
pub fn alarms(detected: &[[bool; SEGMENTS]]) -> usize {
    detected.windows(2).filter(|pair| pair[1] != [false; SEGMENTS] && pair[0] == [false; SEGMENTS]).count()
}

impl ContactSession {
    /// Simulates a session of the reference arm and replays it with this table.
    ///
    /// # Errors
    /// [`Error`] if the file is not a table, or the twin has no such session.
    pub fn new(table: &ArmFile, scenario: Scenario, seed: u64, seconds: f64) -> Result<Self, Box<dyn Error>> {
        let session = TwinSession::new(&Setup::new(scenario, seed), seconds, RATE_HZ)?;
        let mut detected = Vec::new();
        session.replay(table, |_, outcome| detected.push(in_contact(outcome)))?;
        Ok(Self::of(session, detected))
    }

    /// A replayed session, with the contact that the estimator detected in each of its samples.
    #[must_use]
    pub fn of(session: TwinSession, detected: Vec<[bool; SEGMENTS]>) -> Self {
        Self { detected, bends_rad: session.contact_bends_rad, pushes: session.pushes }
    }

    /// Number of contacts that begin; of a free arm, of false alarms.
    #[must_use]
    pub fn alarms(&self) -> usize {
        alarms(&self.detected)
    }

    /// Pushes over 10°, and those that are detected on their segment within half a second of the first touch.
    #[must_use]
    pub fn pushes(&self) -> Found {
        let at = |time_s: f64| (time_s * RATE_HZ).ceil() as usize;
        let strong = self.pushes.iter().filter(|push| push.bend_rad.abs() > STRONG_RAD);
        let whole =
            strong.filter_map(|push| Some((push, self.detected.get(at(push.start_s)..=at(push.start_s + SOON_S))?)));
        whole.fold(Found { found: 0, all: 0 }, |Found { found, all }, (push, detected)| {
            let is_found = detected.iter().any(|detected| detected[push.segment]);
            Found { found: found + usize::from(is_found), all: all + 1 }
        })
    }

    /// Times that an obstacle begins to bend any segment by over 10°, and those that are detected on any segment within
    /// half a second.
    #[must_use]
    pub fn encounters(&self) -> Found {
        let is_strong = |bends: &[f64]| bends.iter().any(|bend| bend.abs() > STRONG_RAD);
        let begins =
            (1..self.detected.len()).filter(|k| is_strong(&self.bends_rad[*k]) && !is_strong(&self.bends_rad[k - 1]));
        let soon = (SOON_S * RATE_HZ) as usize;
        let whole = begins.filter_map(|k| self.detected.get(k..=k + soon));
        whole.fold(Found { found: 0, all: 0 }, |Found { found, all }, detected| {
            let is_found = detected.iter().any(|detected| *detected != [false; SEGMENTS]);
            Found { found: found + usize::from(is_found), all: all + 1 }
        })
    }
}
