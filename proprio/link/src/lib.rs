//! The serial link to a board: real, or the emulated one.
//!
//! One thread reads bytes, stamps them with the time of their arrival, decodes them, and hands [`LinkEvent`]s to every
//! [`Subscription`]. It opens the port again when the cable comes back, begins with a Ping, and sends requests until they
//! are answered. A subscriber may be slow: each subscription has its own bounded queue, which drops its oldest events
//! and counts them, and does not delay the others.
//!
//! ```no_run
//! use std::time::Duration;
//!
//! use proprio_link::{Baud, EventKind, Link, PortSource};
//! use telemetry::{Command, Message, TareMode};
//!
//! let (link, events) = Link::start(Box::new(PortSource::new(None, Baud::default())), None)?;
//! link.request(Command::Tare(TareMode::IfStill))?;
//! while let Some(event) = events.next(Duration::from_secs(1)) {
//!     if let EventKind::Message(Message::Estimate(estimate)) = event.kind {
//!         println!("{:?}", estimate.segments);
//!     }
//! }
//! # Ok::<(), proprio_link::LinkError>(())
//! ```
//!
//! | file | purpose |
//! |---|---|
//! | `handle.rs`, `shared.rs` | [`Link`]: its handle; the state that handle and thread share |
//! | `worker.rs`, `stream_publisher.rs` | the thread; the events of the stream |
//! | `stream_decoder.rs` | bytes to messages; losses, mismatches and restarts |
//! | `requests.rs`, `control.rs` | ids, answers and repetitions; one handle drives at a time |
//! | `relay.rs` | a line that another program has |
//! | `event.rs`, `queue.rs` | events with their time of arrival, and a queue for each subscription |
//! | `file_recorder.rs`, `history.rs` | recording to a file; the bytes that one needs which begins later |
//! | `drive/`, `status.rs`, `tare.rs` | pressures over time; the state of a board within seconds; its zero |
//! | `table/` | transfer of the table to the board and back |
//! | `source.rs` | [`Source`]: opens a line, once or again |
//! | `ports.rs`, `serial.rs`, `virtual_due.rs` | the sources: serial ports and the emulated Due |
//! | `companions.rs` | paths of the emulated board's program and of the firmware |

mod companions;
mod control;
pub mod drive;
mod error;
mod event;
mod file_recorder;
mod handle;
mod history;
mod ports;
mod queue;
mod relay;
mod requests;
mod serial;
mod shared;
mod source;
pub mod status;
mod stream_decoder;
mod stream_publisher;
pub mod table;
mod tare;
mod virtual_due;
mod worker;

pub use companions::{built_firmware, firmware_path, set_program_folder};
pub use error::LinkError;
pub use event::{EventKind, LinkEvent, Mismatch};
pub use file_recorder::FileRecorder;
pub use handle::{Link, PendingRequest};
pub use history::{ReceivedBytes, decoded};
pub use ports::{Port, PortKind, find_due, list, udev_rules};
pub use relay::{Relay, Relayed};
pub use requests::RequestError;
pub use serial::{Baud, PortSource};
pub use shared::{LinkState, Subscription};
pub use source::{Source, Transport};
pub use stream_decoder::{Received, StreamDecoder};
pub use tare::{TareError, Tared, tare};
pub use virtual_due::{Flash, VirtualDue};
