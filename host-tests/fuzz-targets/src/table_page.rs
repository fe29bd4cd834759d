//! The table in the board's flash: an image, a slot, and transfers in pieces.
//!
//! The first byte of an input selects one of them.

use board_estimator::WINDOW;
use board_table::{
    Announcement, BoardTable, FORMAT, MAGIC, MAX_SEGMENTS, PAGE_BYTES, SLOT_BYTES, SlotState, TableStatus, TableStore,
    body_crc, write_image,
};
use embedded_storage::Storage;

use crate::parts::Parts;
use crate::ram_flash::RamFlash;

/// Room for the largest image.
const IMAGE_BYTES: usize = SLOT_BYTES;

/// Reads an image, examines a slot, or transfers tables.
///
/// # Panics
/// Where an accepted image does not encode to one that reads the same; where a slot with right checksums has not the parts that
/// its header states; and where a transfer leaves another table than the one before it, or the new one whole.
pub fn table_page(bytes: &[u8]) {
    let mut parts = Parts::new(bytes);
    match parts.byte().map(|kind| kind % 3) {
        Some(0) => read_image(parts.rest()),
        Some(1) => examine_slot(&mut parts),
        Some(_) => transfer(&mut parts),
        None => {}
    }
}

/// Reads an image, and the image of what was read.
fn read_image(image: &[u8]) {
    let mut table = BoardTable::<MAX_SEGMENTS>::new();
    if table.read(image, WINDOW as u16).is_err() {
        assert!(table.config().is_none() && table.wiring().is_none(), "an image that is refused leaves no content");
        return;
    }
    let config = table.config().expect("it was read");
    assert!(config.anchor.window <= WINDOW as u16 && !config.segments.is_empty());
    let wiring = table.wiring().expect("it was read");
    let mut out = vec![0; IMAGE_BYTES];
    let length = write_image(table.arm(), table.checksum(), &config, Some(wiring), &mut out).expect("it was accepted");
    let mut again = BoardTable::<MAX_SEGMENTS>::new();
    again.read(&out[..length], WINDOW as u16).expect("it was written");
    assert_eq!((again.arm(), again.checksum()), (table.arm(), table.checksum()));
    assert_eq!((again.config(), again.wiring()), (Some(config), Some(wiring)));
}

/// Examines a slot: its header from the input, with the right checksums where the input has so.
fn examine_slot(parts: &mut Parts) {
    let fixes = parts.byte().unwrap_or(0);
    let fields = [(); 3].map(|()| parts.number());
    let mut slot = vec![0xFF; SLOT_BYTES];
    let body = parts.rest();
    let body = &body[..body.len().min(SLOT_BYTES - PAGE_BYTES)];
    slot[PAGE_BYTES..][..body.len()].copy_from_slice(body);
    let [generation, image_bytes, source_bytes] = fields;
    let claimed = image_bytes.saturating_add(source_bytes) as usize;
    let crc = slot[PAGE_BYTES..].get(..claimed).filter(|_| fixes & 1 != 0).map_or(generation, |body| body_crc([body]));
    let mut header = MAGIC.to_vec();
    header.extend([FORMAT.to_le_bytes(), [0; 2]].concat());
    header.extend([generation, image_bytes, source_bytes, crc].map(u32::to_le_bytes).as_flattened());
    let header_crc = if fixes & 2 != 0 { body_crc([&header[..]]) } else { image_bytes };
    header.extend(header_crc.to_le_bytes());
    slot[..header.len()].copy_from_slice(&header);
    let mut flash = RamFlash::new();
    flash.write(0, &slot).expect("a slot fits the flash");
    let store = TableStore::new(flash);
    match SlotState::of(&slot) {
        SlotState::Whole(state) => {
            let stored = store.active().expect("a whole slot counts");
            assert_eq!(stored.header, state);
            assert_eq!((stored.image.len(), stored.source.len()), (image_bytes as usize, source_bytes as usize));
            read_image(stored.image);
        }
        _ => assert_eq!(store.active(), None),
    }
}

/// Transfers tables in pieces, with a right or a wrong checksum, and erases them.
fn transfer(parts: &mut Parts) {
    let mut store = TableStore::new(RamFlash::new());
    let (mut announced, mut is_wrong) = (Vec::new(), false);
    while let Some(kind) = parts.byte() {
        let before = contents(&store);
        let may_change = match kind % 4 {
            0 => {
                let (image_bytes, length) = (parts.number(), parts.number() as usize);
                announced = parts.bytes(length).to_vec();
                let source_bytes = (announced.len() as u32).saturating_sub(image_bytes);
                is_wrong = kind & 0x80 != 0;
                let crc = body_crc([&announced[..]]) ^ u32::from(is_wrong);
                let _ = store.begin(Announcement { image_bytes, source_bytes, crc });
                false
            }
            1 => {
                let _ = store.write(parts.number(), parts.sized());
                false
            }
            2 => {
                let from = store.received_bytes() as usize;
                let piece = announced.iter().skip(from).take(parts.byte().unwrap_or(0).into());
                let _ = store.write(from as u32, &piece.copied().collect::<Vec<u8>>());
                false
            }
            _ if kind & 0x80 == 0 => {
                let committed = store.commit(MAX_SEGMENTS, WINDOW as u16);
                assert!(
                    committed.is_err() || contents(&store) == Some(announced.clone()),
                    "the table that was announced"
                );
                assert!(committed.is_err() || !is_wrong, "a table with a wrong checksum");
                committed.is_ok()
            }
            _ => {
                store.erase().expect("the flash takes it");
                assert_eq!(store.status(), TableStatus::Missing);
                true
            }
        };
        assert!(may_change || contents(&store) == before, "the table changed before the end of a transfer");
    }
}

/// Image and source of the table that counts.
fn contents(store: &TableStore<RamFlash>) -> Option<Vec<u8>> {
    store.active().map(|stored| [stored.image, stored.source].concat())
}
