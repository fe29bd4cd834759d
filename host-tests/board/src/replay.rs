//! The host's own estimates from the board's samples.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::{ArmConfig, Estimator, Method, Q};
use telemetry::{Estimate, Event, MAX_SEGMENTS, Sample, TICK_HZ, Uncertainty};

/// The reference arm's table, which the boards of the tests have in their flash.
///
/// # Panics
/// If the committed file is not a valid table.
#[must_use]
pub fn table() -> ArmFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml");
    ArmFile::load(&path).expect("the reference table is committed")
}

/// The host's results for one sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// The estimate.
    pub estimate: Estimate,
    /// Its uncertainty, which the board sends at a lower rate.
    pub uncertainty: Uncertainty,
    /// Event of a contact that begins or ends with this sample.
    pub contact: Option<Event>,
    /// Segments in contact, a bit each.
    pub contact_mask: u8,
}

/// The host's estimator, in the same fixed point, restarted at the same samples as the board's.
pub struct Replica<'t> {
    config: &'t ArmConfig<'t, Q>,
    estimator: Estimator<'t, Q, MAX_SEGMENTS, 100>,
    tare_epoch: u8,
    touched: u32,
}

impl<'t> Replica<'t> {
    /// The estimator of a board that starts with this table.
    ///
    /// # Panics
    /// If the table is for a longer arm than the board's.
    #[must_use]
    pub fn new(config: &'t ArmConfig<'t, Q>) -> Self {
        Self { config, estimator: Self::start(config), tare_epoch: 0, touched: 0 }
    }

    fn start(config: &'t ArmConfig<'t, Q>) -> Estimator<'t, Q, MAX_SEGMENTS, 100> {
        Estimator::new(config).expect("no longer than the board's")
    }

    /// Processes a sample.
    pub fn update(&mut self, sample: &Sample) -> Replayed {
        if sample.tare_epoch != self.tare_epoch {
            (self.estimator, self.tare_epoch) = (Self::start(self.config), sample.tare_epoch);
        }
        let estimate = self.estimator.update_full(&sample.into());
        let (errors, contacts) = (self.estimator.uncertainties(), self.estimator.contacts());
        let touched = self.estimator.contact_mask();
        let before = std::mem::replace(&mut self.touched, touched);
        Replayed {
            estimate: Estimate::of(sample.tick, &self.estimator.shape(&estimate, Method::Fusion)),
            uncertainty: Uncertainty::of(sample.tick, self.config.segments.len(), &errors, &contacts),
            contact: (touched != before).then_some(Event::Contact(sample.tick, touched as u8)),
            contact_mask: touched as u8,
        }
    }
}

/// Replays samples, the first of which are of a board's start.
///
/// # Panics
/// If the table is not valid, or is for a longer arm than the board's.
pub fn replay<'s>(table: &ArmFile, samples: impl Iterator<Item = &'s Sample>) -> Vec<Replayed> {
    let compiled = table.compile::<Q>(TICK_HZ).expect("a valid table");
    let config = compiled.config();
    let mut replica = Replica::new(&config);
    samples.map(|sample| replica.update(sample)).collect()
}
