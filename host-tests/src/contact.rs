//! Contact as the estimator tells it, against what touches the simulated arm.

use std::ops::AddAssign;

use calibration_tables::{ArmFile, FileError};
use estimator_core::{Estimator, ImuReading, Q, Sample};
use proprio::replay::HostEstimator;
use rig_twin::{Program, Push, Rig, SEGMENTS, Scenario};

/// The rate of the estimator's samples,
const RATE_HZ: f64 = 10.0;
/// and the twin's steps in each.
const TICKS: u32 = 10;
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

impl AddAssign for Found {
    fn add_assign(&mut self, other: Self) {
        *self = Self { found: self.found + other.found, all: self.all + other.all };
    }
}

impl Run {
    /// Runs the twin and, in the board's fixed point, the estimator with this table.
    ///
    /// # Errors
    /// [`FileError`] where the file is no table.
    ///
    /// # Panics
    /// If the table is larger than any estimator.
    pub fn new(table: &ArmFile, scenario: Scenario, seed: u64, seconds: f64) -> Result<Self, FileError> {
        let baked = table.bake::<Q>(RATE_HZ)?;
        let table = baked.config();
        let mut estimator: Box<HostEstimator<Q>> =
            Box::new(Estimator::new(&table).expect("there is room for any table"));
        let (mut rig, program) = (Rig::new(scenario, seed), Program::new(scenario, seed));
        let (mut told, mut bends_rad) = (Vec::new(), Vec::new());
        while rig.time_s() < seconds {
            let mut sample = Sample::missing((rig.time_s() * 1e6) as u64);
            for (i, counts) in rig.adc_counts().into_iter().enumerate() {
                sample.bend[i / 2][i % 2] = Some(counts);
            }
            for (i, registers) in rig.imu_quaternions().into_iter().enumerate() {
                sample.imu[i] = Some(ImuReading::from_bno055(registers));
            }
            estimator.update_full(&sample);
            let contacts = estimator.contacts();
            told.push(core::array::from_fn(|i| contacts[i].in_contact));
            bends_rad.push(rig.contact_bends_rad());
            for _ in 0..TICKS {
                rig.step(1.0 / RATE_HZ / f64::from(TICKS), program.duties(rig.time_s()));
            }
        }
        Ok(Self { told, bends_rad, pushes: rig.pushes().to_vec() })
    }

    /// How often contact is told of where there was none before: of a free arm, false alarms.
    #[must_use]
    pub fn alarms(&self) -> usize {
        self.told.windows(2).filter(|pair| pair[1] != [false; SEGMENTS] && pair[0] == [false; SEGMENTS]).count()
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
