//! Transfers: order, repetition, resumption, refusals.

use board_table::{Announcement, TableError, TableStore, body_crc};
use calibration_tables::ArmFile;
use proptest::prelude::*;

use crate::flash::MockFlash;
use crate::{CHUNK, SEGMENTS, WINDOW, announce, first, image_of, push, second, stored, table};

#[test]
fn a_repeated_chunk_has_no_effect() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    let (image, source) = first();
    let body = [image, source].concat();
    store.begin(announce(&first())).expect("it fits");
    for (index, chunk) in body.chunks(CHUNK).enumerate() {
        for _ in 0..2 {
            store.write((index * CHUNK) as u32, chunk).expect("it follows or repeats");
        }
    }
    store.commit(SEGMENTS, WINDOW).expect("all was received");
    assert_eq!(stored(&mut flash), Some(first()));
}

#[test]
fn a_chunk_out_of_order_is_refused_and_the_transfer_goes_on() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    let body = [first().0, first().1].concat();
    store.begin(announce(&first())).expect("it fits");
    store.write(0, &body[..100]).expect("the first");
    assert_eq!(store.write(200, &body[200..300]), Err(TableError::Order));
    assert_eq!(store.write(50, &body[50..150]), Err(TableError::Order), "an overlap is no repetition");
    store.write(100, &body[100..]).expect("the rest");
    store.commit(SEGMENTS, WINDOW).expect("all was received");
    assert_eq!(stored(&mut flash), Some(first()));
}

#[test]
fn a_transfer_resumes_where_it_stopped_if_it_is_the_same() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    let body = [first().0, first().1].concat();
    store.begin(announce(&first())).expect("it fits");
    store.write(0, &body[..1000]).expect("the first");
    assert_eq!(store.begin(announce(&first())), Ok(1000));
    assert_eq!(store.begin(announce(&second())), Ok(0), "another one begins at 0");
    assert_eq!(store.begin(announce(&first())), Ok(0), "and the earlier one is forgotten");
}

#[test]
fn an_incomplete_transfer_is_not_committed_and_can_be_completed() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    let body = [first().0, first().1].concat();
    store.begin(announce(&first())).expect("it fits");
    store.write(0, &body[..1000]).expect("the first");
    assert_eq!(store.commit(SEGMENTS, WINDOW), Err(TableError::Incomplete));
    store.write(1000, &body[1000..]).expect("the rest");
    assert!(store.commit(SEGMENTS, WINDOW).is_ok());
}

#[test]
fn more_than_was_announced_is_refused() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    store.begin(Announcement { image_bytes: 10, source_bytes: 5, crc: 0 }).expect("it fits");
    assert_eq!(store.write(0, &[0; 16]), Err(TableError::Order));
}

#[test]
fn a_body_longer_than_a_slot_is_refused() {
    for (image_bytes, source_bytes) in [(32 * 1024 - 255, 0), (u32::MAX, 1), (u32::MAX, u32::MAX)] {
        let mut flash = MockFlash::new();
        let mut store = TableStore::new(&mut flash);
        assert_eq!(store.begin(Announcement { image_bytes, source_bytes, crc: 0 }), Err(TableError::TooLong));
    }
}

#[test]
fn chunks_without_a_begin_are_refused() {
    let mut flash = MockFlash::new();
    let mut store = TableStore::new(&mut flash);
    assert_eq!(store.write(0, &[1, 2, 3]), Err(TableError::NotBegun));
    assert_eq!(store.commit(SEGMENTS, WINDOW).map(|_| ()), Err(TableError::NotBegun));
}

#[test]
fn a_wrong_checksum_leaves_the_old_table() {
    let mut flash = MockFlash::new();
    push(&mut TableStore::new(&mut flash), &first()).expect("the flash is good");
    let mut store = TableStore::new(&mut flash);
    let body = [second().0, second().1].concat();
    store.begin(Announcement { crc: 1, ..announce(&second()) }).expect("it fits");
    store.write(0, &body).expect("it follows");
    assert_eq!(store.commit(SEGMENTS, WINDOW).map(|_| ()), Err(TableError::Checksum));
    assert_eq!(stored(&mut flash), Some(first()));
}

#[test]
fn a_table_for_a_larger_arm_than_the_board_has_room_for_is_refused() {
    let mut flash = MockFlash::new();
    push(&mut TableStore::new(&mut flash), &first()).expect("the flash is good");
    let mut file = table();
    file.segments.push(file.segments[5].clone());
    let large = (image_of(&ArmFile { arm: "seven".to_owned(), ..file }), Vec::new());
    assert_eq!(push(&mut TableStore::new(&mut flash), &large), Err(TableError::Segments));
    assert_eq!(stored(&mut flash), Some(first()));
}

#[test]
fn bytes_that_are_no_image_are_refused() {
    let mut flash = MockFlash::new();
    let no_image = (b"not a table".to_vec(), Vec::new());
    assert_eq!(push(&mut TableStore::new(&mut flash), &no_image), Err(TableError::Image));
    let cut = (first().0[..first().0.len() - 1].to_vec(), Vec::new());
    assert_eq!(push(&mut TableStore::new(&mut flash), &cut), Err(TableError::Image));
    let longer = ([&first().0[..], &[0]].concat(), Vec::new());
    assert_eq!(push(&mut TableStore::new(&mut flash), &longer), Err(TableError::Image));
    assert_eq!(stored(&mut flash), None);
}

proptest! {
    #[test]
    fn any_bytes_are_refused_or_read_without_a_panic(image in proptest::collection::vec(any::<u8>(), 0..600)) {
        let mut flash = MockFlash::new();
        let mut store = TableStore::new(&mut flash);
        let announced = Announcement { image_bytes: image.len() as u32, source_bytes: 0, crc: body_crc([&image[..]]) };
        store.begin(announced).expect("it fits");
        if !image.is_empty() {
            store.write(0, &image).expect("it follows");
        }
        let _ = store.commit(SEGMENTS, WINDOW);
    }
}
