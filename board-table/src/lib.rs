//! The calibration table in the flash of the arm's board.
//!
//! The firmware is the same for every arm; the table is stored in pages of its own, and the host replaces it over the
//! serial line. A stored table has two parts: the [image](write_image) that the board uses, and the source, a
//! compressed TOML file that the board returns as it was and does not read.
//!
//! | part | task |
//! |---|---|
//! | [`write_image`], [`BoardTable`] | wiring and estimator's configuration as bytes, and back |
//! | [`Wiring`] | pins and channels of the arm's sensors and regulators |
//! | [`Header`], [`SlotState`] | a slot of the flash: header, checksums |
//! | [`TableStore`] | two slots, of which the newest whole one counts; transfer in chunks |
//!
//! A loss of power at any time leaves the earlier table or the new one, never a mixture: a transfer writes to the slot
//! that is not in use, and its header, the last page written, makes it count.
//!
//! ```
//! use board_table::{Announcement, TableStore, body_crc};
//! # use embedded_storage::{ReadStorage, Storage};
//! # struct Ram(Vec<u8>);
//! # impl ReadStorage for Ram {
//! #     type Error = ();
//! #     fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), ()> {
//! #         bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
//! #         Ok(())
//! #     }
//! #     fn capacity(&self) -> usize {
//! #         self.0.len()
//! #     }
//! # }
//! # impl Storage for Ram {
//! #     fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), ()> {
//! #         self.0[offset as usize..][..bytes.len()].copy_from_slice(bytes);
//! #         Ok(())
//! #     }
//! # }
//! # impl AsRef<[u8]> for Ram {
//! #     fn as_ref(&self) -> &[u8] {
//! #         &self.0
//! #     }
//! # }
//! # let file = calibration_tables::ArmFile::parse(include_str!("../../calibration-tables/planar-6.toml"))?;
//! # let compiled = file.compile::<estimator_core::Q>(100.0)?;
//! # let mut image = vec![0; 8192];
//! # let length = board_table::write_image("planar-6", compiled.checksum(), &compiled.config(), None, &mut image)?;
//! # let image = &image[..length];
//! let mut store = TableStore::new(Ram(vec![0xFF; 64 * 1024]));
//! store.begin(Announcement { image_bytes: image.len() as u32, source_bytes: 0, crc: body_crc([image]) })?;
//! for (index, chunk) in image.chunks(160).enumerate() {
//!     store.write(index as u32 * 160, chunk)?;
//! }
//! store.commit(6, 100)?;
//! assert_eq!(store.active().map(|table| table.image), Some(image));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]

mod error;
mod image;
mod slot;
mod store;
mod wiring;

pub use error::{TableError, WiringError};
pub use image::{ARM_NAME_BYTES, BoardTable, write_image};
pub use slot::{FORMAT, Header, MAGIC, PAGE_BYTES, SLOT_BYTES, SlotState, body_crc};
pub use store::{Announcement, STORE_BYTES, StoredTable, TableStatus, TableStore};
pub use wiring::{
    ANALOG_PINS, IMU_ADDRESSES, IMU_CHANNELS, ImuAddress, MAX_FULL_SCALE_PA, MAX_REGULATORS, MAX_SEGMENTS,
    REFERENCE_FULL_SCALE_PA, REGULATOR_PINS, RegulatorWiring, SegmentWiring, Wiring,
};
