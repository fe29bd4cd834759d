//! A live arm for other programs of this workspace, by the arguments of `proprio`.

use calibration_tables::ArmFile;
use proprio_link::{Link, Subscription};

use crate::args::LinkArgs;
use crate::commands::link;
use crate::commands::motion::Motion;
use crate::error::Error;

/// Source of a live arm's data.
#[derive(Debug)]
pub enum LiveArm {
    /// A board.
    Board(Box<Board>),
    /// A running monitor has the board's line, and streams to Foxglove at this address.
    Stream(String),
}

/// An open line to a board.
#[derive(Debug)]
pub struct Board {
    // It ends before the link.
    _motion: Option<Motion>,
    /// The link.
    pub link: Link,
    /// Its events from the first byte on.
    pub events: Subscription,
    /// The table that was given.
    pub table: Option<ArmFile>,
}

impl LiveArm {
    /// Opens the line of a board, or finds the running monitor that has it. The arm of an emulated board moves.
    ///
    /// # Errors
    /// [`Error`] where the line cannot be opened; [`Error::NoStream`] where the monitor does not stream.
    pub fn open(args: &LinkArgs) -> Result<Self, Error> {
        if let Some(monitor) = link::monitor(args) {
            let stream = monitor.stream().ok_or(Error::NoStream(monitor.address()))?;
            return Ok(Self::Stream(stream.to_string()));
        }
        let (table, link, events) = link::open(args)?;
        let motion = args.emulated.then(|| Motion::start(link.second_handle(), args)).transpose()?;
        Ok(Self::Board(Box::new(Board { _motion: motion, link, events, table: table.map(|table| table.file) })))
    }
}
