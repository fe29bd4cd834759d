//! Contact as the estimator tells it, against what touches the simulated arm.

use std::error::Error;
use std::ops::AddAssign;

use calibration_tables::ArmFile;
use proprio_analysis::Outcome;
use rig_twin::{Push, SEGMENTS, Scenario, Setup};

use crate::twin::TwinSession;

/// The rate of the estimator's samples.
const RATE_HZ: f64 = 10.0;
/// What bends a segment by more is to be found,
const STRONG_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// within this time.
const SOON_S: f64 = 0.5;

/// A run, sample by sample and segment by segment.
pub struct Run {
    /// Whether the estimator says that something touches the segment.
    pub told: Vec<[bool; SEGMENTS]>,
    /// What contact adds to its bend angle, rad.
    pub bends_rad: Vec<[f64; SEGMENTS]>,
    pushes: Vec<Push>,
}

/// How many there were, and how many of them were found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Found {
    /// Found.
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
pub fn alarms(told: &[[bool; SEGMENTS]]) -> usize {
    told.windows(2).filter(|pair| pair[1] != [false; SEGMENTS] && pair[0] == [false; SEGMENTS]).count()
}

impl Run {
    /// Simulates a session of the reference arm and replays it with this table.
    ///
    /// # Errors
    /// [`Error`] where the file is no table, or the twin has no such session.
    pub fn new(table: &ArmFile, scenario: Scenario, seed: u64, seconds: f64) -> Result<Self, Box<dyn Error>> {
        let session = TwinSession::new(&Setup::new(scenario, seed), seconds, RATE_HZ)?;
        let mut told = Vec::new();
        session.replay(table, |_, outcome| told.push(in_contact(outcome)))?;
        Ok(Self::of(session, told))
    }

    /// A session that was replayed, with what the estimator said of each of its samples.
    #[must_use]
    pub fn of(session: TwinSession, told: Vec<[bool; SEGMENTS]>) -> Self {
        Self { told, bends_rad: session.contact_bends_rad, pushes: session.pushes }
    }

    /// Number of contacts that begin; of a free arm, of false alarms.
    #[must_use]
    pub fn alarms(&self) -> usize {
        alarms(&self.told)
    }

    /// Pushes over 10°, and those of them that are told of on their segment within half a second of the first touch.
    #[must_use]
    pub fn pushes(&self) -> Found {
        let at = |time_s: f64| (time_s * RATE_HZ).ceil() as usize;
        let strong = self.pushes.iter().filter(|push| push.bend_rad.abs() > STRONG_RAD);
        let whole =
            strong.filter_map(|push| Some((push, self.told.get(at(push.start_s)..=at(push.start_s + SOON_S))?)));
        whole.fold(Found { found: 0, all: 0 }, |Found { found, all }, (push, told)| {
            let is_found = told.iter().any(|told| told[push.segment]);
            Found { found: found + usize::from(is_found), all: all + 1 }
        })
    }

    /// Times that an obstacle comes to bend any segment by over 10°, and those of them that are told of on any segment
    /// within half a second.
    #[must_use]
    pub fn encounters(&self) -> Found {
        let is_strong = |bends: &[f64; SEGMENTS]| bends.iter().any(|bend| bend.abs() > STRONG_RAD);
        let begins =
            (1..self.told.len()).filter(|k| is_strong(&self.bends_rad[*k]) && !is_strong(&self.bends_rad[k - 1]));
        let soon = (SOON_S * RATE_HZ) as usize;
        let whole = begins.filter_map(|k| self.told.get(k..=k + soon));
        whole.fold(Found { found: 0, all: 0 }, |Found { found, all }, told| {
            let is_found = told.iter().any(|told| *told != [false; SEGMENTS]);
            Found { found: found + usize::from(is_found), all: all + 1 }
        })
    }
}
