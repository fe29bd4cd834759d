//! The serial link to a board: real, or the emulated one.
//!
//! One thread reads bytes, stamps them with the time of their arrival, decodes them, and hands [`Event`]s to every
//! [`Subscription`]. It opens the port again when the cable comes back, begins with a Ping, and sends requests until they
//! are answered. Whoever listens may be slow: each subscription has its own bounded queue, which drops its oldest events
//! and counts them, and holds up nobody else.
//!
//! ```no_run
//! use std::time::Duration;
//!
//! use proprio_link::{Baud, Link, PortSource, What};
//! use telemetry::{Command, Message};
//!
//! let (link, events) = Link::start(Box::new(PortSource::new(None, Baud::default())), None)?;
//! link.request(Command::Tare)?;
//! while let Some(event) = events.next(Duration::from_secs(1)) {
//!     if let What::Message(Message::Estimate(estimate)) = event.what {
//!         println!("{:?}", estimate.segments);
//!     }
//! }
//! # Ok::<(), proprio_link::LinkError>(())
//! ```
//!
//! | file | what it is for |
//! |---|---|
//! | `handle.rs` | [`Link`]: what the rest of the program holds of it |
//! | `worker.rs` | the thread |
//! | `intake.rs` | bytes to messages; losses, mismatches and restarts |
//! | `requests.rs` | ids, answers and repetitions |
//! | `event.rs`, `queue.rs` | events with their time of arrival, and a queue for each subscription |
//! | `file_recorder.rs` | recording to a file |
//! | `drive/`, `status.rs` | pressures over time; the state of a board within seconds |
//! | `source.rs` | where a line comes from, and that it may come again |
//! | `ports.rs`, `serial.rs`, `virtual_due.rs` | the sources that there are |

pub mod drive;
mod error;
mod event;
mod file_recorder;
mod handle;
mod intake;
mod ports;
mod queue;
mod requests;
mod serial;
mod source;
pub mod status;
mod virtual_due;
mod worker;

pub use error::LinkError;
pub use event::{Event, Mismatch, What};
pub use file_recorder::FileRecorder;
pub use handle::{Link, LinkState, Subscription};
pub use intake::{Intake, Taken};
pub use ports::{Kind, Port, find_due, list};
pub use requests::RequestError;
pub use serial::{Baud, PortSource};
pub use source::{Source, Transport};
pub use virtual_due::VirtualDue;
