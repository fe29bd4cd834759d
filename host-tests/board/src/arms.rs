//! Arms other than the reference arm, with their wiring, table and simulated rig.

use board_table::{ImuAddress, RegulatorWiring, SegmentWiring, Wiring};
use calibration_tables::{AnalogPin, ArmFile, BoardSegmentToml, BoardToml, DigitalPin, ImuToml, RegulatorToml};
use rig_twin::{Layout, Scenario, Setup};
use virtual_due::WiredRig;

use crate::board::Board;
use crate::flash::flash_with;
use crate::replay::table;
use proprio_link::table::StoredTable;

/// An arm of 1 to 8 segments of the reference arm's kind, with a wiring of its own.
pub struct WiredArm {
    /// Its table.
    pub file: ArmFile,
    wiring: Wiring,
}

impl WiredArm {
    /// The arm of this wiring. Its bend maps are those of the reference arm, so that its shape is not accurate.
    ///
    /// # Panics
    /// Never: the reference arm is calibrated.
    #[must_use]
    pub fn new(wiring: Wiring) -> Self {
        let reference = table();
        let segments = wiring.segments.iter().enumerate().map(|(i, wired)| {
            let mut segment = reference.segments[i % reference.segments.len()].clone();
            let sensors = wired.bend.iter().flatten().count();
            segment.bend.as_mut().expect("the reference arm is calibrated").truncate(sensors);
            if let Some(coupled) = &mut segment.coupled_to {
                coupled.segment = i;
            }
            segment
        });
        let file = ArmFile {
            arm: format!("planar-{}", wiring.segments.len()),
            segments: segments.collect(),
            board: Some(board(&wiring)),
            ..reference.clone()
        };
        Self { file, wiring }
    }

    /// A board with this arm and its table, with power just come up.
    ///
    /// # Panics
    /// If the table does not fit the board.
    #[must_use]
    pub fn board(&self, scenario: Scenario, seed: u64) -> Board {
        let stored = StoredTable::new(&self.file, self.file.to_toml().as_bytes()).expect("it fits the board");
        Board::with_flash(self.rig(scenario, seed), &flash_with(&stored))
    }

    /// The simulated arm on its pins.
    ///
    /// # Panics
    /// If the twin cannot simulate it.
    #[must_use]
    pub fn rig(&self, scenario: Scenario, seed: u64) -> WiredRig {
        let layout = Layout::of_file(&self.file).expect("1 to 8 segments");
        WiredRig::of(&Setup { layout, ..Setup::new(scenario, seed) }, &self.wiring)
    }
}

/// The section `[board]` of a wiring.
fn board(wiring: &Wiring) -> BoardToml {
    let segment = |SegmentWiring { bend, imu }: &SegmentWiring| BoardSegmentToml {
        bend: bend.iter().flatten().map(|pin| AnalogPin(*pin)).collect(),
        imu: imu.map(|ImuAddress { channel, address }| ImuToml { channel, address }),
    };
    let regulator = |RegulatorWiring { pin, full_scale_pa }: &RegulatorWiring| RegulatorToml {
        pin: DigitalPin(*pin),
        full_scale_kpa: f64::from(*full_scale_pa) / 1000.0,
    };
    BoardToml {
        segments: wiring.segments.iter().map(segment).collect(),
        regulators: wiring.regulators.iter().map(regulator).collect(),
    }
}
