//! Files to begin with.

use calibration_tables::ArmFile;

/// An arm description with nothing that could be left out.
pub const DESCRIPTION: &str = r#"
format = 1
arm = "finger"
rate_hz = 10.0

[[segment]]
length_mm = 80.0
offset_mm = 17.0
offset_at = "end"
"#;

/// A table of two segments with every key; a line each, so that a test can replace one.
pub const TABLE: &str = r#"
format = 1
arm = "finger"
rate_hz = 10.0

[tare]
seconds = 1.0
heading_deg = [5.0, -5.0]

[anchor]
window = 100
threshold_deg = 0.5
rate_hz = 10.0

[[segment]]
length_mm = 80.0
offset_mm = 17.0
offset_at = "end"
bend = [{ c0 = -1.5, c1 = 0.8, c2 = 0.1, rmse_deg = 4.7, volts = [0.4, 2.6] }]
orient = { q = 0.16, r_imu = 0.0002, r_bend = 0.002, h_imu = 1.0, h_bend = 1.0 }
coord = { q = 0.0002, r_imu = 3e-7, r_bend = 3e-6, h_imu = 1.0, h_bend = 1.0 }

[[segment]]
length_mm = 60.0
offset_mm = 0.0
offset_at = "start"
bend = []
"#;

pub fn parse(text: &str) -> ArmFile {
    ArmFile::parse(text).unwrap_or_else(|error| panic!("{error}"))
}

/// [`TABLE`] with another text in one place.
pub fn edited(from: &str, to: &str) -> String {
    assert!(TABLE.contains(from), "{from} is not in the table");
    TABLE.replacen(from, to, 1)
}
