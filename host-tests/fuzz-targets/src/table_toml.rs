//! Tables and arm descriptions: the TOML file.

use board_estimator::WINDOW;
use board_table::{BoardTable, MAX_SEGMENTS, SLOT_BYTES, TableError, write_image};
use calibration_tables::{ArmFile, CompiledTable, FileError};
use estimator_core::{Estimator, Q};

/// Parses a text.
///
/// # Panics
/// Where an accepted file is not written to a text with the same values to the last bit; where an estimator refuses a compiled
/// table; where the board reads another configuration; and where an error names a line that the text does not have.
pub fn table_toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let file = match ArmFile::parse(text) {
        Ok(file) => file,
        Err(FileError::Syntax { line, .. } | FileError::Value { line: Some(line), .. }) => {
            assert!((1..=text.lines().count() + 1).contains(&line), "line {line}");
            return;
        }
        Err(_) => return,
    };
    let written = file.to_toml();
    let again = ArmFile::parse(&written).unwrap_or_else(|error| panic!("{error}: {written}"));
    // The Debug form of a float is exact, and distinguishes −0 from 0.
    assert_eq!(format!("{again:?}"), format!("{file:?}"));
    if let Ok(compiled) = file.compile::<Q>(file.rate_hz) {
        let config = compiled.config();
        assert!(
            Estimator::<Q, { calibration_tables::MAX_SEGMENTS }, { calibration_tables::MAX_WINDOW as usize }>::new(
                &config
            )
            .is_ok()
        );
        store(&file, &compiled);
    }
}

/// Writes the image of a table, and reads it as the board does.
fn store(file: &ArmFile, compiled: &CompiledTable<Q>) {
    let (config, mut out) = (compiled.config(), vec![0; SLOT_BYTES]);
    let length = match write_image(&file.arm, compiled.checksum(), &config, file.wiring().as_ref(), &mut out) {
        Err(TableError::Segments) if config.segments.len() > MAX_SEGMENTS => return,
        length => length.expect("the image of a table fits"),
    };
    let mut table = BoardTable::<MAX_SEGMENTS>::new();
    match table.read(&out[..length], WINDOW as u16) {
        Err(TableError::Window) if config.anchor.window > WINDOW as u16 => {}
        read => {
            read.expect("it was written");
            assert_eq!(table.config(), Some(config));
        }
    }
}
