//! The host's own estimates from the board's samples.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::{Estimator, Method, Q};
use telemetry::{Estimate, Event, SEGMENTS, Sample, TICK_HZ, Uncertainty, contact_flags};

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
#[derive(Debug, Clone, Copy, PartialEq)]
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
/// If the reference table is not valid.
pub fn replay<'s>(samples: impl Iterator<Item = &'s Sample>) -> Vec<Replayed> {
    let compiled = table().compile::<Q>(TICK_HZ).expect("the reference file is a valid table");
    let table = compiled.config();
    let start = || Estimator::<Q, SEGMENTS, 100>::new(&table).expect("the reference arm has six segments");
    let (mut estimator, mut tare, mut touched_before) = (start(), 0, [false; SEGMENTS]);
    let mut replayed = Vec::new();
    for sample in samples {
        if sample.tare_epoch != tare {
            (estimator, tare) = (start(), sample.tare_epoch);
        }
        let estimate = estimator.update_full(&sample.into());
        let (errors, contacts) = (estimator.uncertainties(), estimator.contacts());
        let touched = contact_flags(&contacts);
        replayed.push(Replayed {
            estimate: Estimate::of(sample.tick, &estimator.shape(&estimate, Method::Fusion)),
            uncertainty: Uncertainty::of(sample.tick, &errors, &contacts),
            contact: (touched != touched_before).then_some(Event::Contact(sample.tick, touched)),
        });
        touched_before = touched;
    }
    replayed
}
