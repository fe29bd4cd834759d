//! The board's wiring from an arm description or a table.

use board_table::{ANALOG_PINS, Wiring};
use calibration_tables::ArmFile;

use super::error::TableImageError;

/// The wiring of an arm: that of its section `[board]`, or else the reference wiring for its number of segments.
///
/// # Errors
/// [`TableImageError::Segments`], [`TableImageError::BendSensors`] or [`TableImageError::ReferencePins`] for an arm that is
/// larger than the board.
pub fn wiring(file: &ArmFile) -> Result<Wiring, TableImageError> {
    let wiring = file.wiring().ok_or(TableImageError::Segments(file.segments.len()))?;
    if file.board.is_none() {
        check_pins(file, &wiring)?;
    }
    Ok(wiring)
}

/// Checks that the reference wiring has a pin for each bend sensor of a table.
fn check_pins(file: &ArmFile, reference: &Wiring) -> Result<(), TableImageError> {
    let sensors: Vec<usize> = file.segments.iter().map(|segment| segment.bend.as_ref().map_or(0, Vec::len)).collect();
    let total = sensors.iter().sum();
    if total > usize::from(ANALOG_PINS) {
        return Err(TableImageError::BendSensors(total));
    }
    for (segment, (wired, sensors)) in (1..).zip(reference.segments.iter().zip(sensors)) {
        let pins = wired.bend.iter().flatten().count();
        if sensors > pins {
            return Err(TableImageError::ReferencePins { segment, sensors, pins });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use board_table::{
        BoardTable, IMU_ADDRESSES, ImuAddress, MAX_SEGMENTS, REGULATOR_PINS, RegulatorWiring, SegmentWiring,
        TableError, WiringError,
    };
    use calibration_tables::{
        AnalogPin, BoardSegmentToml, BoardToml, DigitalPin, FileError, ImuToml, PLANAR_6_TABLE, RegulatorToml,
    };

    use super::super::stored::StoredTable;
    use super::*;

    fn table() -> ArmFile {
        ArmFile::parse(PLANAR_6_TABLE).expect("the reference table is valid")
    }

    /// The reference table with these numbers of bend sensors.
    fn with_sensors(sensors: &[usize]) -> ArmFile {
        let mut file = table();
        let segment = file.segments[0].clone();
        file.segments = sensors
            .iter()
            .map(|count| {
                let mut segment = segment.clone();
                segment.bend.as_mut().expect("it is a table").truncate(*count);
                segment
            })
            .collect();
        file
    }

    /// A table of one segment with this wiring.
    fn wired(segment: BoardSegmentToml, regulators: Vec<RegulatorToml>) -> ArmFile {
        ArmFile { board: Some(BoardToml { segments: vec![segment], regulators }), ..with_sensors(&[0]) }
    }

    /// Wiring in the image that the board reads.
    fn on_board(file: &ArmFile) -> Wiring {
        let stored = StoredTable::new(file, file.to_toml().as_bytes()).expect("it fits the board");
        let mut table = BoardTable::<MAX_SEGMENTS>::new();
        table.read(&stored.image, 100).expect("the image is valid");
        table.wiring().expect("the table has content").clone()
    }

    #[test]
    fn the_board_gets_the_wiring_of_the_section() {
        let imu = Some(ImuToml { channel: 3, address: 0x29 });
        let bend = vec![AnalogPin(11), AnalogPin(4)];
        let regulators = vec![RegulatorToml { pin: DigitalPin(40), full_scale_kpa: 100.5 }];
        let found = on_board(&wired(BoardSegmentToml { bend, imu }, regulators));
        let segment = SegmentWiring { bend: [Some(11), Some(4)], imu: Some(ImuAddress { channel: 3, address: 0x29 }) };
        assert_eq!(&found.segments[..], [segment]);
        assert_eq!(&found.regulators[..], [RegulatorWiring { pin: 40, full_scale_pa: 100_500 }]);
    }

    #[test]
    fn the_board_gets_the_reference_wiring_of_a_table_without_the_section() {
        assert_eq!(on_board(&table()), Wiring::reference(6));
        assert_eq!(on_board(&with_sensors(&[2, 1, 0])), Wiring::reference(3));
    }

    #[test]
    fn an_arm_description_gives_the_board_its_wiring_and_no_bend_map() {
        let mut description = with_sensors(&[2, 1]);
        description.segments.iter_mut().for_each(|segment| segment.bend = None);
        let stored = StoredTable::new(&description, b"").expect("it fits the board");
        let mut table = BoardTable::<MAX_SEGMENTS>::new();
        table.read(&stored.image, 100).expect("the image is valid");
        assert_eq!(table.wiring(), Some(&Wiring::reference(2)));
        let config = table.config().expect("the table has content");
        assert!(config.segments.iter().all(|segment| segment.bend.iter().all(Option::is_none)));

        description.segments[0].bend = Some(Vec::new());
        let error = StoredTable::new(&description, b"").expect_err("one segment is calibrated and one is not");
        assert!(matches!(error, TableImageError::File(FileError::NotCalibrated(2))), "{error}");
    }

    #[test]
    fn the_board_gets_the_wiring_of_an_arm_description_too() {
        let imu = Some(ImuToml { channel: 3, address: 0x29 });
        let mut file = wired(BoardSegmentToml { bend: vec![AnalogPin(5), AnalogPin(6)], imu }, Vec::new());
        file.segments[0].bend = None;
        let found = on_board(&file);
        assert_eq!(found.segments[0].bend, [Some(5), Some(6)]);
        assert!(found.regulators.is_empty());
    }

    #[test]
    fn a_table_of_nine_segments_is_refused() {
        let error = StoredTable::new(&with_sensors(&[0; 9]), b"").expect_err("it must be refused");
        assert_eq!(error.to_string(), "the arm has 9 segments, and the board has room for 8");
    }

    #[test]
    fn a_table_of_thirteen_bend_sensors_is_refused() {
        let error = wiring(&with_sensors(&[2, 2, 2, 2, 2, 2, 1])).expect_err("it must be refused");
        assert_eq!(error.to_string(), "the arm has 13 bend sensors, and the board has 12 analog pins");
    }

    #[test]
    fn bend_sensors_that_the_reference_wiring_has_no_pin_for_are_refused() {
        let error = wiring(&with_sensors(&[2, 1, 1, 1, 1, 1, 1])).expect_err("it must be refused");
        assert!(matches!(error, TableImageError::ReferencePins { segment: 7, sensors: 1, pins: 0 }), "{error}");
    }

    /// The file and the image are checked apart; they must accept the same.
    #[test]
    fn the_file_accepts_what_the_board_has() {
        let read = |file: &ArmFile| ArmFile::parse(&file.to_toml());
        let mut files = Vec::new();
        for pin in 0..=ANALOG_PINS {
            files.push(wired(BoardSegmentToml { bend: vec![AnalogPin(pin)], imu: None }, Vec::new()));
        }
        for channel in 0..=board_table::IMU_CHANNELS {
            for address in [0, 0x27, IMU_ADDRESSES[0], IMU_ADDRESSES[1], 0x2A] {
                let imu = Some(ImuToml { channel, address });
                files.push(wired(BoardSegmentToml { bend: Vec::new(), imu }, Vec::new()));
            }
        }
        let bare = BoardSegmentToml { bend: Vec::new(), imu: None };
        for pin in 0..=64 {
            let regulators = vec![RegulatorToml { pin: DigitalPin(pin), full_scale_kpa: 280.0 }];
            files.push(wired(bare.clone(), regulators));
        }
        for full_scale_kpa in [0.0, 0.001, 1000.0, 1000.001] {
            let regulators = vec![RegulatorToml { pin: DigitalPin(REGULATOR_PINS[0]), full_scale_kpa }];
            files.push(wired(bare.clone(), regulators));
        }
        let accepted = |file: &ArmFile| wiring(file).is_ok_and(|wiring| wiring.check().is_ok());
        for file in &files {
            let result = read(file);
            assert!(!matches!(result, Err(FileError::Syntax { .. })), "{result:?}");
            // An address of 0 is not representable in the image's row, and refused by both.
            assert_eq!(result.is_ok(), accepted(file), "{:?}", file.board);
        }
        let count = files.iter().filter(|file| accepted(file)).count();
        assert_eq!(count, 12 + 16 + 8 + 2);
    }

    #[test]
    fn a_wiring_that_was_not_read_from_a_file_is_checked_for_the_board() {
        let regulators = vec![RegulatorToml { pin: DigitalPin(10), full_scale_kpa: 280.0 }];
        let file = wired(BoardSegmentToml { bend: Vec::new(), imu: None }, regulators);
        let error = StoredTable::new(&file, b"").expect_err("it must be refused");
        assert!(matches!(error, TableImageError::Table(TableError::Wiring(WiringError::PinWithoutPwm(10)))), "{error}");
    }
}
