//! Requests about the table in the board's flash.
//!
//! A page of the flash takes some milliseconds to write, so the server runs in a task of its own, of the lowest priority,
//! and one request at a time.

use board_estimator::WINDOW;
use board_table::{Announcement, BoardTable, MAX_REGULATORS, MAX_SEGMENTS, TableError, TableStore};
use embedded_storage::Storage;
use telemetry::{Command, Message, Refusal, TableChunk, TableState, TableStatus, vector};

/// Table and messages have room for the same arms.
const _: () = assert!(MAX_SEGMENTS == telemetry::MAX_SEGMENTS && MAX_REGULATORS == telemetry::MAX_REGULATORS);

/// Result of a request that was executed.
#[derive(Debug, Clone, PartialEq)]
pub struct TableAnswer {
    /// The message to send after the reply, if any.
    pub message: Option<Message>,
    /// The table has changed: restart the board.
    pub restart: bool,
}

/// Server of the requests about the table.
#[derive(Debug)]
pub struct TableServer<F> {
    store: TableStore<F>,
}

impl<F: Storage + AsRef<[u8]>> TableServer<F> {
    /// A server for the store in a flash.
    pub fn new(flash: F) -> Self {
        Self { store: TableStore::new(flash) }
    }

    /// Reads the table into `table`, which is empty if there is no usable one. Returns its state.
    #[inline(never)]
    pub fn load(&self, table: &mut BoardTable<MAX_SEGMENTS>) -> TableState {
        let is_usable = self.store.active().is_none_or(|stored| table.read(stored.image, WINDOW as u16).is_ok());
        if is_usable { self.state() } else { self.skip() }
    }

    /// State of the table that is not used.
    pub fn skip(&self) -> TableState {
        TableState { status: TableStatus::Unusable, ..self.state() }
    }

    /// Executes a request about the table.
    ///
    /// # Errors
    /// The reason for a refusal; [`Refusal::Unknown`] for a command that is not about the table.
    pub fn execute(&mut self, command: &Command) -> Result<TableAnswer, Refusal> {
        match command {
            Command::TableBegin(announced) => {
                let announced = Announcement {
                    image_bytes: announced.image_bytes,
                    source_bytes: announced.source_bytes,
                    crc: announced.crc,
                };
                self.store.begin(announced).map_err(refusal)?;
            }
            Command::TableWrite(chunk) => {
                self.store.write(chunk.offset, &chunk.bytes).map_err(refusal)?;
                return Ok(TableAnswer { message: None, restart: false });
            }
            Command::TableCommit => {
                self.store.commit(MAX_SEGMENTS, WINDOW as u16).map_err(refusal)?;
            }
            Command::TableErase => self.store.erase().map_err(refusal)?,
            Command::TableRead(offset) => return self.read(*offset),
            _ => return Err(Refusal::Unknown),
        }
        let restart = matches!(command, Command::TableCommit | Command::TableErase);
        Ok(TableAnswer { message: Some(Message::Table(self.state())), restart })
    }

    /// State of the store.
    fn state(&self) -> TableState {
        let (status, header) = match self.store.status() {
            board_table::TableStatus::Whole(header) => (TableStatus::InUse, Some(header)),
            board_table::TableStatus::Missing => (TableStatus::Missing, None),
            board_table::TableStatus::Foreign => (TableStatus::Foreign, None),
            board_table::TableStatus::Damaged => (TableStatus::Damaged, None),
        };
        TableState {
            status,
            generation: header.map_or(0, |header| header.generation),
            image_bytes: header.map_or(0, |header| header.image_bytes),
            source_bytes: header.map_or(0, |header| header.source_bytes),
            crc: header.map_or(0, |header| header.crc),
            received_bytes: self.store.received_bytes(),
        }
    }

    /// The piece of the table at an offset; empty after its end.
    fn read(&self, offset: u32) -> Result<TableAnswer, Refusal> {
        let stored = self.store.active().ok_or(Refusal::NoTable)?;
        let body = stored.image.iter().chain(stored.source).skip(offset as usize);
        let bytes = vector(body.copied());
        Ok(TableAnswer { message: Some(Message::TableData(TableChunk { offset, bytes })), restart: false })
    }
}

fn refusal(error: TableError) -> Refusal {
    match error {
        TableError::TooLong => Refusal::TableTooLong,
        TableError::Image => Refusal::TableImage,
        TableError::Wiring(_) => Refusal::TableWiring,
        TableError::Segments | TableError::Window => Refusal::TableCapacity,
        TableError::NotBegun | TableError::Order | TableError::Incomplete => Refusal::TableOrder,
        TableError::Checksum => Refusal::TableChecksum,
        TableError::Flash => Refusal::Flash,
    }
}
