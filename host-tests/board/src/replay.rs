//! The host's own estimates of what the board has read.

use std::path::Path;

use calibration_tables::ArmFile;
use estimator_core::{Estimator, Method, Q};
use telemetry::{Estimate, Event, SEGMENTS, Sample, Uncertainty, contact_flags};

/// Ticks a second of the board.
const RATE_HZ: f64 = 100.0;

/// The reference arm's table, which the firmware has baked in.
///
/// # Panics
/// If the committed file is none.
#[must_use]
pub fn table() -> ArmFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml");
    ArmFile::load(&path).expect("the reference table is committed")
}

/// What the host's estimator makes of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replayed {
    /// The estimate.
    pub estimate: Estimate,
    /// How far it may be off, which the board says from time to time.
    pub uncertainty: Uncertainty,
    /// Where contact has begun or ended.
    pub contact: Option<Event>,
}

/// What the host's estimator makes of the samples, in the same fixed point, started anew wherever the board's was.
///
/// # Panics
/// If the reference table is none.
pub fn replay<'s>(samples: impl Iterator<Item = &'s Sample>) -> Vec<Replayed> {
    let baked = table().bake::<Q>(RATE_HZ).expect("the reference table bakes");
    let table = baked.config();
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
