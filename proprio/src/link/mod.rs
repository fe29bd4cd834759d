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
//! use proprio::link::{Baud, Link, PortSource, What};
//! use telemetry::{Command, Message};
//!
//! let (link, events) = Link::start(Box::new(PortSource::new(None, Baud::default())), None)?;
//! link.request(Command::Tare)?;
//! while let Some(event) = events.next(Duration::from_secs(1)) {
//!     if let What::Message(Message::Estimate(estimate)) = event.what {
//!         println!("{:?}", estimate.segments);
//!     }
//! }
//! # Ok::<(), proprio::error::Error>(())
//! ```
//!
//! | file | what it is for |
//! |---|---|
//! | `handle.rs` | [`Link`]: what the rest of the program holds of it |
//! | `worker.rs` | the thread |
//! | `intake.rs`, `runs.rs` | bytes to messages; losses, mismatches and restarts |
//! | `requests.rs` | ids, answers and repetitions |
//! | `event.rs`, `queue.rs`, `clock.rs` | what the thread says, to whom, and when it came |
//! | `board_clock.rs` | the board's time on the host's clock, and its drift |
//! | `source.rs` | where a line comes from, and that it may come again |
//! | `ports.rs`, `serial.rs`, `virtual_due.rs` | the sources that there are |

mod board_clock;
mod clock;
mod error;
mod event;
mod handle;
mod intake;
mod ports;
mod queue;
mod requests;
mod runs;
mod serial;
mod source;
mod virtual_due;
mod worker;

pub use board_clock::{BoardClock, Drift};
pub use clock::{HostClock, HostNs};
pub use error::LinkError;
pub use event::{Event, Mismatch, What};
pub use handle::{Link, LinkState, Subscription};
pub use intake::{Intake, Taken};
pub use ports::{Kind, Port, find_due, list};
pub use requests::RequestError;
pub(crate) use runs::{Place, Runs};
pub use serial::{Baud, PortSource};
pub use source::{Source, Transport};
pub use virtual_due::VirtualDue;
