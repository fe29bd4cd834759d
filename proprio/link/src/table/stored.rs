//! The form in which the board stores a table: the image that it reads, and the compressed TOML file.

use std::io::{self, Read, Write};

use board_table::{Announcement, STORE_BYTES, TableError, TableStore, body_crc, write_image};
use calibration_tables::ArmFile;
use embedded_storage::{ReadStorage, Storage};
use estimator_core::Q;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use telemetry::{Command, TICK_HZ, TableAnnouncement};

use super::error::TableImageError;
use super::wiring::wiring;

/// Room for an image, bytes: more than a slot of the board.
const IMAGE_ROOM: usize = STORE_BYTES;

/// Longest TOML file of a board, bytes. A damaged source is not expanded further.
const LONGEST_SOURCE: u64 = 1 << 20;

/// A table as the board stores it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredTable {
    /// The estimator's configuration.
    pub image: Vec<u8>,
    /// The TOML file, compressed.
    pub source: Vec<u8>,
    /// Checksum by which board and host compare their tables.
    pub checksum: u32,
}

impl StoredTable {
    /// The stored form of a table and of its file's text. An arm description gives the board its wiring, without any bend map:
    /// the board then sends samples for a first sweep, and no shape.
    ///
    /// # Errors
    /// [`TableImageError`] where some segments are calibrated and others are not, or on an arm that does not fit the board.
    pub fn new(file: &ArmFile, toml: &[u8]) -> Result<Self, TableImageError> {
        let wiring = wiring(file)?;
        let compiled = if file.is_description() {
            file.without_bend_maps().compile::<Q>(TICK_HZ)?
        } else {
            file.compile::<Q>(TICK_HZ)?
        };
        let checksum = compiled.checksum();
        let mut image = vec![0; IMAGE_ROOM];
        let length = write_image(&file.arm, checksum, &compiled.config(), Some(&wiring), &mut image)?;
        image.truncate(length);
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(toml)?;
        Ok(Self { image, source: encoder.finish()?, checksum })
    }

    /// Lengths and checksum, which the board receives first.
    fn announcement(&self) -> Announcement {
        Announcement {
            image_bytes: self.image.len() as u32,
            source_bytes: self.source.len() as u32,
            crc: body_crc([&self.image[..], &self.source[..]]),
        }
    }

    /// The command that begins the transfer of this table.
    #[must_use]
    pub fn begin(&self) -> Command {
        let Announcement { image_bytes, source_bytes, crc } = self.announcement();
        Command::TableBegin(TableAnnouncement { image_bytes, source_bytes, crc })
    }

    /// Image and source, as they are sent.
    #[must_use]
    pub fn body(&self) -> Vec<u8> {
        [&self.image[..], &self.source[..]].concat()
    }

    /// Content of the board's store with this table alone, for the flash of an emulated board.
    ///
    /// # Errors
    /// [`TableImageError::Table`] if it does not fit.
    pub fn store(&self) -> Result<Vec<u8>, TableImageError> {
        let mut flash = Ram(vec![0xFF; STORE_BYTES]);
        let mut store = TableStore::new(&mut flash);
        store.begin(self.announcement())?;
        store.write(0, &self.body())?;
        store.commit(usize::MAX, u16::MAX)?;
        Ok(flash.0)
    }
}

/// Expands a compressed TOML file.
///
/// # Errors
/// [`io::Error`] if it is damaged.
pub(super) fn expand(source: &[u8]) -> io::Result<String> {
    let mut toml = String::new();
    ZlibDecoder::new(source).take(LONGEST_SOURCE).read_to_string(&mut toml)?;
    Ok(toml)
}

/// A flash in memory.
struct Ram(Vec<u8>);

impl Ram {
    fn part(&mut self, offset: u32, length: usize) -> Result<&mut [u8], TableError> {
        self.0.get_mut(offset as usize..).and_then(|rest| rest.get_mut(..length)).ok_or(TableError::Flash)
    }
}

impl ReadStorage for &mut Ram {
    type Error = TableError;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), TableError> {
        bytes.copy_from_slice(self.part(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl Storage for &mut Ram {
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), TableError> {
        self.part(offset, bytes.len())?.copy_from_slice(bytes);
        Ok(())
    }
}

impl AsRef<[u8]> for Ram {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
