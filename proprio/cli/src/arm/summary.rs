//! An arm on its board: wiring, counts, and load of the serial line.

use std::path::Path;

use board_table::Wiring;
use calibration_tables::ArmFile;
use proprio_link::table::{TableImageError, wiring};
use serde::Serialize;
use telemetry::{LINE_BYTES_PER_SECOND, STREAM_BYTES_PER_SECOND};

use super::line_budget::LineBudget;
use crate::text_tables::{table, text};

/// Note on a file that has no wiring of its own.
pub const REFERENCE_WIRING: &str = "it has no section [board]: the wiring is the reference of docs/how-to/wiring.md";

/// An arm on its board.
#[derive(Serialize)]
pub struct ArmSummary {
    path: String,
    arm: String,
    is_table: bool,
    segments: usize,
    bend_sensors: usize,
    imus: usize,
    regulators: usize,
    wiring: Wiring,
    line_bytes_per_s: LineBudget,
    #[serde(skip)]
    has_reference_wiring: bool,
}

impl ArmSummary {
    /// The summary of an arm description or a table.
    pub fn of(path: &Path, file: &ArmFile) -> Result<Self, TableImageError> {
        let wiring = wiring(file)?;
        let (segments, regulators) = (wiring.segments.len(), wiring.regulators.len());
        Ok(Self {
            path: path.display().to_string(),
            arm: file.arm.clone(),
            is_table: file.bend_sensors().is_ok(),
            segments,
            bend_sensors: wiring.bend_sensors(),
            imus: wiring.segments.iter().filter(|segment| segment.imu.is_some()).count(),
            regulators,
            line_bytes_per_s: LineBudget::of(segments, regulators),
            wiring,
            has_reference_wiring: file.board.is_none(),
        })
    }

    /// The summary as text.
    pub fn text(&self) -> String {
        let kind = if self.is_table { "table" } else { "description" };
        let Self { path, arm, segments, bend_sensors, imus, regulators, .. } = self;
        let counts = format!(
            "{path}: {kind} of arm {arm}: {}, {}, {}, {}",
            counted(*segments, "segment"),
            counted(*bend_sensors, "bend sensor"),
            counted(*imus, "IMU"),
            counted(*regulators, "regulator")
        );
        let note = if self.has_reference_wiring { format!("{REFERENCE_WIRING}\n") } else { String::new() };
        format!("{counts}\n{note}\n{}\n{}", wiring_table(&self.wiring), line(&self.line_bytes_per_s))
    }
}

/// Pins and channels of the sensors and regulators.
pub fn wiring_table(wiring: &Wiring) -> String {
    let mut sensors = table(&["segment", "bend sensor a", "bend sensor b", "IMU"]);
    for (number, segment) in (1..).zip(&wiring.segments) {
        let [a, b] = segment.bend.map(|pin| pin.map_or_else(|| "-".to_owned(), |pin| format!("A{pin}")));
        let imu = segment
            .imu
            .map_or_else(|| "-".to_owned(), |imu| format!("channel {}, address {:#04x}", imu.channel, imu.address));
        sensors.add_row([number.to_string(), a, b, imu]);
    }
    let mut regulators = table(&["regulator", "pin", "full scale kPa"]);
    for (number, regulator) in (1..).zip(&wiring.regulators) {
        let full_scale_kpa = f64::from(regulator.full_scale_pa) / 1000.0;
        regulators.add_row([number.to_string(), format!("D{}", regulator.pin), full_scale_kpa.to_string()]);
    }
    let sensors = text(&mut sensors) + "\n";
    if wiring.regulators.is_empty() { sensors } else { format!("{sensors}\n{}\n", text(&mut regulators)) }
}

/// Load of the serial line.
fn line(budget: &LineBudget) -> String {
    let estimates = format!("estimates, {} Hz", budget.estimate_hz);
    let rows = [
        ("samples, 100 Hz", budget.samples),
        (&estimates, budget.estimates),
        ("uncertainties, 4 Hz", budget.uncertainties),
        ("health, 5 Hz", budget.health),
        ("hello, 1 Hz", budget.hello),
        ("all", budget.total()),
    ];
    let mut table = table(&["messages", "bytes/s"]);
    for (name, bytes) in rows {
        table.add_row([name.to_owned(), bytes.to_string()]);
    }
    let rate = if budget.is_halved() {
        "with estimates at 100 Hz they would take more, so the board sends every second one"
    } else {
        "the estimates have their whole rate"
    };
    let text = text(&mut table);
    format!("{text}\nof the line's {LINE_BYTES_PER_SECOND} bytes/s these may take {STREAM_BYTES_PER_SECOND}; {rate}\n")
}

/// A number and its noun.
fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
