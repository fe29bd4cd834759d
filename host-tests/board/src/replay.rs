//! The host's own estimates from the board's samples.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::{Estimator, Method, Q};
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
}

/// Replays the samples with the host's estimator, in the same fixed point, restarted at the same samples as the board's.
///
/// # Panics
/// If the table is not valid, or is for a longer arm than the board's.
pub fn replay<'s>(table: &ArmFile, samples: impl Iterator<Item = &'s Sample>) -> Vec<Replayed> {
    let compiled = table.compile::<Q>(TICK_HZ).expect("a valid table");
    let config = compiled.config();
    let segments = config.segments.len();
    let start = || Estimator::<Q, MAX_SEGMENTS, 100>::new(&config).expect("no longer than the board's");
    let (mut estimator, mut tare, mut touched_before) = (start(), 0, 0);
    let mut replayed = Vec::new();
    for sample in samples {
        if sample.tare_epoch != tare {
            (estimator, tare) = (start(), sample.tare_epoch);
        }
        let estimate = estimator.update_full(&sample.into());
        let (errors, contacts) = (estimator.uncertainties(), estimator.contacts());
        let touched = estimator.contact_mask();
        replayed.push(Replayed {
            estimate: Estimate::of(sample.tick, &estimator.shape(&estimate, Method::Fusion)),
            uncertainty: Uncertainty::of(sample.tick, segments, &errors, &contacts),
            contact: (touched != touched_before).then_some(Event::Contact(sample.tick, touched as u8)),
        });
        touched_before = touched;
    }
    replayed
}
