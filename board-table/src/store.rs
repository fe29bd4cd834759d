//! The store: two slots, of which the newest whole one counts, and the transfer of a new table.
//!
//! A transfer writes to the slot that does not count: first it erases the header, then it writes the body page by page,
//! and last the header. The slot in use is not touched.

use embedded_storage::Storage;

use crate::error::TableError;
use crate::image;
use crate::slot::{Header, PAGE_BYTES, SLOT_BYTES, SlotState, body_crc};

/// Size of the store, bytes.
pub const STORE_BYTES: usize = 2 * SLOT_BYTES;

/// A page without content, as the flash is after its erasure.
const ERASED: [u8; PAGE_BYTES] = [0xFF; PAGE_BYTES];

/// What a host will send.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Announcement {
    /// Length of the image, bytes.
    pub image_bytes: u32,
    /// Length of the source, bytes.
    pub source_bytes: u32,
    /// CRC-32 of both.
    pub crc: u32,
}

/// State of the store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableStatus {
    /// The table that counts.
    Whole(Header),
    /// No table was stored.
    Missing,
    /// A table of another format version, and no whole one.
    Foreign,
    /// A damaged table, and no whole one.
    Damaged,
}

/// A stored table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StoredTable<'f> {
    /// Its header.
    pub header: Header,
    /// The image.
    pub image: &'f [u8],
    /// The source.
    pub source: &'f [u8],
}

/// A transfer under way.
#[derive(Debug)]
struct Transfer {
    slot: usize,
    announced: Announcement,
    received: usize,
    /// The bytes of the page that is not full.
    page: [u8; PAGE_BYTES],
}

/// The two slots of a flash that is mapped to memory: at its start, [`STORE_BYTES`] long.
///
/// The slots are examined when the store is made and after each change.
#[derive(Debug)]
pub struct TableStore<F> {
    flash: F,
    states: [SlotState; 2],
    transfer: Option<Transfer>,
}

impl<F: Storage + AsRef<[u8]>> TableStore<F> {
    /// The store of a flash.
    pub fn new(flash: F) -> Self {
        let mut store = Self { flash, states: [SlotState::Empty; 2], transfer: None };
        store.examine();
        store
    }

    /// State of the store.
    pub fn status(&self) -> TableStatus {
        let [a, b] = self.states;
        match (newest(self.states), a, b) {
            (Some((_, header)), ..) => TableStatus::Whole(header),
            (None, SlotState::Empty, SlotState::Empty) => TableStatus::Missing,
            (None, SlotState::Foreign(_), _) | (None, _, SlotState::Foreign(_)) => TableStatus::Foreign,
            _ => TableStatus::Damaged,
        }
    }

    /// The table that counts.
    pub fn active(&self) -> Option<StoredTable<'_>> {
        let (slot, header) = newest(self.states)?;
        let body = self.body(slot, header.body_bytes())?;
        let (image, source) = body.split_at_checked(header.image_bytes as usize)?;
        Some(StoredTable { header, image, source })
    }

    /// Begins a transfer, or resumes the one under way if it is the same. Returns the number of bytes received so far, the
    /// offset of the next chunk.
    ///
    /// # Errors
    /// [`TableError::TooLong`] or [`TableError::Flash`].
    pub fn begin(&mut self, announced: Announcement) -> Result<u32, TableError> {
        if let Some(transfer) = self.transfer.as_ref().filter(|transfer| transfer.announced == announced) {
            return Ok(transfer.received as u32);
        }
        self.transfer = None;
        if announced.length() > SLOT_BYTES - PAGE_BYTES {
            return Err(TableError::TooLong);
        }
        let slot = newest(self.states).map_or(0, |(slot, _)| 1 - slot);
        self.program(slot * SLOT_BYTES, &ERASED)?;
        self.examine();
        self.transfer = Some(Transfer { slot, announced, received: 0, page: ERASED });
        Ok(0)
    }

    /// Bytes received of the transfer under way; 0 without one.
    pub fn received_bytes(&self) -> u32 {
        self.transfer.as_ref().map_or(0, |transfer| transfer.received as u32)
    }

    /// Takes a chunk of the body, image first. A chunk that was received before is taken again without effect.
    ///
    /// # Errors
    /// [`TableError::NotBegun`], [`TableError::Order`] or [`TableError::Flash`], which ends the transfer.
    pub fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), TableError> {
        let transfer = self.transfer.as_ref().ok_or(TableError::NotBegun)?;
        let (received, end) = (transfer.received, (offset as usize).saturating_add(bytes.len()));
        if end <= received {
            return Ok(());
        }
        if offset as usize != received || end > transfer.announced.length() {
            return Err(TableError::Order);
        }
        for byte in bytes {
            let transfer = self.transfer.as_mut().ok_or(TableError::NotBegun)?;
            let place = transfer.received % PAGE_BYTES;
            if let Some(cell) = transfer.page.get_mut(place) {
                *cell = *byte;
            }
            transfer.received += 1;
            if place == PAGE_BYTES - 1 {
                self.write_page()?;
            }
        }
        Ok(())
    }

    /// Ends a transfer: compares the checksum with what the flash holds, and makes the new table count. `segments` and
    /// `window` are the capacity of the board's estimator.
    ///
    /// # Errors
    /// [`TableError::NotBegun`]; [`TableError::Incomplete`], after which chunks can follow; and those that end the
    /// transfer and leave the table in use: [`TableError::Checksum`], [`TableError::Flash`], and those of
    /// [`BoardTable::read`](crate::BoardTable::read).
    pub fn commit(&mut self, segments: usize, window: u16) -> Result<Header, TableError> {
        let transfer = self.transfer.as_ref().ok_or(TableError::NotBegun)?;
        let (slot, announced, length) = (transfer.slot, transfer.announced, transfer.announced.length());
        if transfer.received < length {
            return Err(TableError::Incomplete);
        }
        if !length.is_multiple_of(PAGE_BYTES) {
            self.write_page()?;
        }
        self.transfer = None;
        let body = self.body(slot, length).ok_or(TableError::TooLong)?;
        if body_crc([body]) != announced.crc {
            return Err(TableError::Checksum);
        }
        let image = body.get(..announced.image_bytes as usize).ok_or(TableError::Image)?;
        image::check(image, segments, window)?;
        let generation = newest(self.states).map_or(1, |(_, header)| header.generation.wrapping_add(1));
        let Announcement { image_bytes, source_bytes, crc } = announced;
        let header = Header { generation, image_bytes, source_bytes, crc };
        let mut page = ERASED;
        page.iter_mut().zip(header.to_bytes()).for_each(|(cell, byte)| *cell = byte);
        self.program(slot * SLOT_BYTES, &page)?;
        self.examine();
        Ok(header)
    }

    /// Erases both tables.
    ///
    /// # Errors
    /// [`TableError::Flash`].
    pub fn erase(&mut self) -> Result<(), TableError> {
        self.transfer = None;
        // The one in use last: a loss of power in between leaves it, and not the one before it.
        let in_use = newest(self.states).map_or(0, |(slot, _)| slot);
        self.program((1 - in_use) * SLOT_BYTES, &ERASED)?;
        self.program(in_use * SLOT_BYTES, &ERASED)?;
        self.examine();
        Ok(())
    }

    /// Programs the page under way, which is the last one before the number of received bytes.
    fn write_page(&mut self) -> Result<(), TableError> {
        let transfer = self.transfer.as_mut().ok_or(TableError::NotBegun)?;
        let page = core::mem::replace(&mut transfer.page, ERASED);
        let index = transfer.received.saturating_sub(1) / PAGE_BYTES;
        let offset = transfer.slot * SLOT_BYTES + PAGE_BYTES * (1 + index);
        self.program(offset, &page).inspect_err(|_| self.transfer = None)
    }

    /// Writes a page and compares what the flash holds then.
    fn program(&mut self, offset: usize, page: &[u8; PAGE_BYTES]) -> Result<(), TableError> {
        self.flash.write(offset as u32, page).map_err(|_| TableError::Flash)?;
        let held = self.flash.as_ref().get(offset..).and_then(|rest| rest.first_chunk());
        (held == Some(page)).then_some(()).ok_or(TableError::Flash)
    }

    /// Examines both slots, with the checksums over all of them.
    fn examine(&mut self) {
        self.states = [0, 1].map(|slot| self.slot(slot).map_or(SlotState::Empty, SlotState::of));
    }

    fn slot(&self, slot: usize) -> Option<&[u8]> {
        self.flash.as_ref().get(slot * SLOT_BYTES..)?.get(..SLOT_BYTES)
    }

    fn body(&self, slot: usize, length: usize) -> Option<&[u8]> {
        self.slot(slot)?.get(PAGE_BYTES..)?.get(..length)
    }
}

impl Announcement {
    /// Length of the body, bytes.
    const fn length(self) -> usize {
        self.image_bytes.saturating_add(self.source_bytes) as usize
    }
}

/// Number and header of the newest whole slot.
fn newest(states: [SlotState; 2]) -> Option<(usize, Header)> {
    match states {
        [SlotState::Whole(a), SlotState::Whole(b)] if b.generation > a.generation => Some((1, b)),
        [SlotState::Whole(a), _] => Some((0, a)),
        [_, SlotState::Whole(b)] => Some((1, b)),
        _ => None,
    }
}
