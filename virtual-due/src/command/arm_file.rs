//! The simulated arm and its wiring, from an arm description or a table.

use std::path::Path;

use board_table::{ImuAddress, RegulatorWiring, SegmentWiring, Wiring};
use calibration_tables::{ArmFile, BoardSegmentToml, BoardToml, ImuToml, RegulatorToml};
use rig_twin::{Layout, Scenario, Setup};
use virtual_due::rig::WiredRig;

use super::error::Error;

/// The rig in a session of a scenario and a seed: the arm of a file in the file's wiring, or the reference arm in its own.
pub fn rig(path: Option<&Path>, scenario: Scenario, seed: u64) -> Result<WiredRig, Error> {
    let Some(path) = path else { return Ok(WiredRig::new(scenario, seed)) };
    let shown = || path.display().to_string();
    let file = ArmFile::load(path).map_err(|error| Error::Arm { path: shown(), error })?;
    let layout = Layout::of_file(&file).map_err(|error| Error::Layout { path: shown(), error })?;
    Ok(WiredRig::of(&Setup { layout, ..Setup::new(scenario, seed) }, &wiring(&file)))
}

/// The wiring of an arm: that of its section `[board]`, or else the reference wiring for its number of segments.
fn wiring(file: &ArmFile) -> Wiring {
    let Some(BoardToml { segments, regulators }) = &file.board else { return Wiring::reference(file.segments.len()) };
    Wiring { segments: segments.iter().map(segment).collect(), regulators: regulators.iter().map(regulator).collect() }
}

fn segment(segment: &BoardSegmentToml) -> SegmentWiring {
    let mut pins = segment.bend.iter().map(|pin| pin.0);
    SegmentWiring {
        bend: [pins.next(), pins.next()],
        imu: segment.imu.map(|ImuToml { channel, address }| ImuAddress { channel, address }),
    }
}

fn regulator(regulator: &RegulatorToml) -> RegulatorWiring {
    RegulatorWiring { pin: regulator.pin.0, full_scale_pa: (regulator.full_scale_kpa * 1000.0).round() as u32 }
}
