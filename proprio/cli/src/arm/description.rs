//! Text of a new arm's description.

use board_table::{IMU_ADDRESSES, REGULATOR_PINS};
use telemetry::TICK_HZ;

use super::choice::NewArm;

/// The arm description of a new arm, with comments: pins in the order of the sensors, an IMU on each segment.
pub fn description(arm: &NewArm) -> String {
    let name = serde_json::to_string(&arm.name).expect("a text has a form in JSON, which is one of TOML too");
    let mut text = format!(
        r"# Arm description. `proprio calibrate` makes a table of it and a session with camera truth; `proprio
# check` checks it and prints its wiring. docs/reference/table.md explains the keys.
format = 1
arm = {name}
rate_hz = {TICK_HZ:?}

# The arm rests straight for the first second of a session.
[tare]
seconds = 1.0

"
    );
    text += "# Wiring (docs/how-to/wiring.md): bend sensors a and b of a segment on A0 to A11; its IMU on a\n";
    text += "# channel of the multiplexer, 0 to 7, at address 0x28 or 0x29. Change it to fit yours.\n[board]\n";
    let [address, _] = IMU_ADDRESSES;
    let mut pins = 0..;
    for (channel, sensors) in arm.bend_sensors.iter().enumerate() {
        let bend: Vec<String> =
            pins.by_ref().take(usize::from(*sensors)).map(|pin: u8| format!("\"A{pin}\"")).collect();
        let bend = bend.join(", ");
        let imu = format!("{{ channel = {channel}, address = {address:#04x} }}");
        section(&mut text, &format!("[[board.segment]]\nbend = [{bend}]\nimu = {imu}"));
    }
    if arm.regulators > 0 {
        let pins = REGULATOR_PINS.map(|pin| format!("D{pin}")).join(", ");
        let comment = format!("# Regulators, each on one of {pins}, and its pressure at full duty.");
        line(&mut text, &comment);
    }
    for pin in REGULATOR_PINS.iter().take(usize::from(arm.regulators)) {
        let full_scale_kpa = arm.full_scale_kpa;
        section(&mut text, &format!("[[board.regulator]]\npin = \"D{pin}\"\nfull_scale_kpa = {full_scale_kpa:?}"));
    }
    text += "# Segments from the base: length of the curved part, and of the rigid connector at its \"start\" or\n";
    text += "# \"end\". Measure both.\n";
    for length_mm in &arm.lengths_mm {
        section(&mut text, &format!("[[segment]]\nlength_mm = {length_mm:?}\noffset_mm = 0.0\noffset_at = \"end\""));
    }
    text.truncate(text.trim_end().len());
    text + "\n"
}

/// Appends a section and an empty line.
fn section(text: &mut String, lines: &str) {
    line(text, lines);
    text.push('\n');
}

fn line(text: &mut String, line: &str) {
    text.push_str(line);
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use calibration_tables::ArmFile;

    use super::*;

    fn arm() -> NewArm {
        NewArm {
            name: "octo \"8\"\n".to_owned(),
            lengths_mm: vec![90.0, 80.5, 70.0],
            bend_sensors: vec![2, 0, 1],
            regulators: 2,
            full_scale_kpa: 250.0,
        }
    }

    #[test]
    fn a_description_is_read_as_the_arm_that_was_chosen() {
        let file = ArmFile::parse(&description(&arm())).expect("it is an arm description");
        assert_eq!(file.arm, "octo \"8\"\n");
        assert_eq!(file.segments.iter().map(|segment| segment.length_mm).collect::<Vec<_>>(), [90.0, 80.5, 70.0]);
        assert!(file.segments.iter().all(|segment| segment.bend.is_none()));
        let board = file.board.expect("the section is there");
        let pins: Vec<Vec<u8>> =
            board.segments.iter().map(|segment| segment.bend.iter().map(|pin| pin.0).collect()).collect();
        assert_eq!(pins, [vec![0, 1], vec![], vec![2]]);
        let imus: Vec<_> =
            board.segments.iter().map(|segment| segment.imu.map(|imu| (imu.channel, imu.address))).collect();
        assert_eq!(imus, [Some((0, 0x28)), Some((1, 0x28)), Some((2, 0x28))]);
        let regulators: Vec<_> = board.regulators.iter().map(|of| (of.pin.0, of.full_scale_kpa)).collect();
        assert_eq!(regulators, [(6, 250.0), (7, 250.0)]);
    }

    #[test]
    fn the_largest_arm_of_the_board_has_a_description() {
        let largest =
            NewArm { lengths_mm: vec![60.0; 8], bend_sensors: vec![2, 2, 2, 2, 1, 1, 1, 1], regulators: 8, ..arm() };
        assert!(largest.check().is_ok());
        let file = ArmFile::parse(&description(&largest)).expect("it is an arm description");
        let wiring = proprio_link::table::wiring(&file).expect("it fits the board");
        assert_eq!(wiring.check(), Ok(()));
        assert_eq!(wiring.bend_sensors(), 12);
        assert_eq!((wiring.segments.len(), wiring.regulators.len()), (8, 8));
    }

    #[test]
    fn lines_are_at_most_100_characters_long() {
        let text = description(&arm());
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}
