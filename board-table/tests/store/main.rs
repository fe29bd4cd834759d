//! The store: transfer, loss of power, damage.

mod flash;
mod transfer;
mod wiring;

use board_table::{
    Announcement, BoardTable, SLOT_BYTES, TableError, TableStatus, TableStore, Wiring, body_crc, write_image,
};
use calibration_tables::ArmFile;
use estimator_core::Q;

use flash::MockFlash;

/// Capacity of the board's estimator.
const SEGMENTS: usize = 6;
const WINDOW: u16 = 100;

/// Size of a chunk, bytes: no divisor of a page.
const CHUNK: usize = 160;

fn table() -> ArmFile {
    ArmFile::parse(include_str!("../../../calibration-tables/planar-6.toml")).expect("the reference table is valid")
}

/// A table of one segment, which is small enough to be transferred thousands of times.
fn small(name: &str) -> (Vec<u8>, Vec<u8>) {
    let mut file = ArmFile { arm: name.to_owned(), ..table() };
    file.segments.truncate(1);
    (image_of(&file), (0..300_u32).map(|i| i as u8).collect())
}

fn image_of(file: &ArmFile) -> Vec<u8> {
    image_with(file, None).expect("it fits")
}

fn image_with(file: &ArmFile, wiring: Option<&Wiring>) -> Result<Vec<u8>, TableError> {
    let compiled = file.compile::<Q>(100.0).expect("a table compiles");
    let mut image = vec![0; 8192];
    let length = write_image(&file.arm, compiled.checksum(), &compiled.config(), wiring, &mut image)?;
    image.truncate(length);
    Ok(image)
}

/// The reference table, and a source of 300 bytes.
fn first() -> (Vec<u8>, Vec<u8>) {
    (image_of(&table()), (0..300_u32).map(|i| i as u8).collect())
}

/// The reference table under another name, with another source.
fn second() -> (Vec<u8>, Vec<u8>) {
    (image_of(&ArmFile { arm: "another arm".to_owned(), ..table() }), b"another source".to_vec())
}

fn announce((image, source): &(Vec<u8>, Vec<u8>)) -> Announcement {
    Announcement {
        image_bytes: image.len() as u32,
        source_bytes: source.len() as u32,
        crc: body_crc([&image[..], &source[..]]),
    }
}

/// Transfers a table; stops at the first error.
fn push(store: &mut TableStore<&mut MockFlash>, table: &(Vec<u8>, Vec<u8>)) -> Result<(), TableError> {
    store.begin(announce(table))?;
    let body = [&table.0[..], &table.1[..]].concat();
    for (index, chunk) in body.chunks(CHUNK).enumerate() {
        store.write((index * CHUNK) as u32, chunk)?;
    }
    store.commit(SEGMENTS, WINDOW).map(|_| ())
}

/// Image and source of the table that counts.
fn stored(flash: &mut MockFlash) -> Option<(Vec<u8>, Vec<u8>)> {
    let store = TableStore::new(flash);
    store.active().map(|table| (table.image.to_vec(), table.source.to_vec()))
}

#[test]
fn a_pushed_table_is_read_back_bit_for_bit() {
    let mut flash = MockFlash::new();
    push(&mut TableStore::new(&mut flash), &first()).expect("the flash is good");
    let (image, source) = stored(&mut flash).expect("it was stored");
    assert_eq!((&image, &source), (&first().0, &first().1));
    let mut read = BoardTable::<SEGMENTS>::new();
    read.read(&image, WINDOW).expect("the image is valid");
    let compiled = table().compile::<Q>(100.0).expect("a table compiles");
    assert_eq!(read.config(), Some(compiled.config()));
    assert_eq!((read.arm(), read.checksum()), ("planar-6", compiled.checksum()));
}

#[test]
fn a_loss_of_power_at_any_byte_leaves_the_old_or_the_new_table() {
    let mut before = MockFlash::new();
    push(&mut TableStore::new(&mut before), &small("before")).expect("the flash is good");
    let mut whole = before.clone();
    push(&mut TableStore::new(&mut whole), &small("after")).expect("the flash is good");
    let mut seen = [0, 0];
    for budget in 0.. {
        let mut flash = MockFlash { budget, ..before.clone() };
        let done = push(&mut TableStore::new(&mut flash), &small("after"));
        let table = stored(&mut flash).expect("one of the two counts");
        if table == small("after") {
            seen[1] += 1;
        } else {
            assert_eq!(table, small("before"), "after {budget} bytes");
            seen[0] += 1;
        }
        if done.is_ok() {
            break;
        }
    }
    assert!(seen[0] > small("after").0.len() && seen[1] >= 1, "{seen:?}");
}

#[test]
fn a_loss_of_power_while_both_are_erased_leaves_the_newest_table_or_none() {
    let mut before = MockFlash::new();
    push(&mut TableStore::new(&mut before), &first()).expect("the flash is good");
    push(&mut TableStore::new(&mut before), &second()).expect("the flash is good");
    for budget in 0.. {
        let mut flash = MockFlash { budget, ..before.clone() };
        let done = TableStore::new(&mut flash).erase();
        let table = stored(&mut flash);
        assert!(table.is_none() || table == Some(second()), "after {budget} bytes");
        if done.is_ok() {
            assert_eq!(table, None);
            break;
        }
    }
}

#[test]
fn each_flipped_bit_of_a_stored_table_is_noticed() {
    let mut flash = MockFlash::new();
    let table = first();
    push(&mut TableStore::new(&mut flash), &table).expect("the flash is good");
    let used = (0..28).chain(256..256 + table.0.len() + table.1.len());
    for place in used {
        let bit = 1 << (place % 8);
        flash.bytes[place] ^= bit;
        let status = TableStore::new(&mut flash).status();
        flash.bytes[place] ^= bit;
        assert_eq!(status, TableStatus::Damaged, "byte {place}");
    }
}

#[test]
fn an_erased_flash_has_no_table() {
    let mut flash = MockFlash::new();
    assert_eq!(TableStore::new(&mut flash).status(), TableStatus::Missing);
    assert_eq!(stored(&mut flash), None);
}

#[test]
fn a_table_of_another_format_version_is_foreign() {
    let mut flash = MockFlash::new();
    push(&mut TableStore::new(&mut flash), &first()).expect("the flash is good");
    // Version 1 had no wiring.
    for version in [1, 3] {
        flash.bytes[4] = version;
        let crc = body_crc([&flash.bytes[..24]]);
        flash.bytes[24..28].copy_from_slice(&crc.to_le_bytes());
        assert_eq!(TableStore::new(&mut flash).status(), TableStatus::Foreign, "version {version}");
    }
}

#[test]
fn the_newest_whole_table_counts_after_many_transfers() {
    let mut flash = MockFlash::new();
    for generation in 1..=5 {
        let table = if generation % 2 == 1 { first() } else { second() };
        push(&mut TableStore::new(&mut flash), &table).expect("the flash is good");
        let mut store = TableStore::new(&mut flash);
        assert!(matches!(store.status(), TableStatus::Whole(header) if header.generation == generation));
        assert_eq!(store.active().map(|table| table.image), Some(&table.0[..]));
        // A transfer that is given up changes nothing.
        store.begin(announce(&first())).expect("the flash is good");
        assert_eq!(store.active().map(|table| table.image), Some(&table.0[..]));
    }
}

#[test]
fn a_page_that_does_not_take_what_is_written_is_an_error_and_the_old_table_counts() {
    let mut flash = MockFlash::new();
    push(&mut TableStore::new(&mut flash), &first()).expect("the flash is good");
    // A bit of the second slot that is 0 in the new table.
    let place = 256 + second().0.iter().position(|byte| byte & 1 == 0).expect("some byte is even");
    flash.stuck = Some((SLOT_BYTES + place, 1));
    assert_eq!(push(&mut TableStore::new(&mut flash), &second()), Err(TableError::Flash));
    assert_eq!(stored(&mut flash), Some(first()));
}
