//! Recordings: all data that a board has sent, as an [MCAP](https://mcap.dev) file.
//!
//! The channel [`RAW`](topics::RAW) holds the received bytes, each message with the time of its arrival; a replay decodes
//! them again. The other channels are for people and their programs: ROS 2 messages in CDR. `docs/reference/files.md` lists them.
//!
//! | file | purpose |
//! |---|---|
//! | `writer.rs`, `channel.rs`, `topics.rs` | writes a recording; its channels and their topics |
//! | `board_messages.rs` | the board's messages on their channels, for a file or a live stream |
//! | `reader.rs`, `read_error.rs` | reads bytes, truth, set-points and marks |
//! | `attached_table.rs` | the table that is attached |
//! | `rows.rs` | the rows of a recording |
//! | `recover.rs` | recovery of a file that was cut or damaged |
//! | `scanner.rs`, `window.rs`, `form.rs`, `hole.rs` | whole records of a damaged file, and its holes |
//! | `own_channels.rs` | the channels of every recording of proprio |
//! | `decompress.rs`, `summary.rs` | compressed chunks; the index at a file's end |
//! | `messages.rs`, `schema.rs`, `cdr.rs` | ROS 2 messages |

mod attached_table;
mod board_messages;
mod cdr;
mod channel;
#[cfg(test)]
mod damage_tests;
mod decompress;
mod form;
mod hole;
mod messages;
mod own_channels;
mod read_error;
mod reader;
mod recover;
mod rows;
mod scanner;
pub mod schema;
mod summary;
pub mod topics;
mod window;
mod writer;

pub(crate) use attached_table::attached_table;
pub use board_messages::{BoardMessages, MessageInfo, MessageSink};
pub use cdr::CdrWriter;
pub use channel::{BOARD_CHANNELS, CDR, Channel, ROS2_MESSAGE};
pub use hole::{Hole, HoleTimes};
pub use messages::{SegmentEnd, chip_number, write_header};
pub use read_error::ReadError;
pub(crate) use reader::is_damaged_begin;
pub use reader::{Item, RawReader, Reader, is_recording};
pub use recover::{RecoverError, Recovery, recover};
pub(crate) use summary::Summary;

pub(crate) use rows::RecordedRows;
pub use writer::Recorder;
