//! Sources of a line to a board.

use std::io;

use super::LinkError;

/// An open line.
pub trait Transport: Send {
    /// Reads the bytes that have arrived, or waits some milliseconds for them; 0 where none came.
    ///
    /// # Errors
    /// The system's error when the line is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Sends bytes, all of them.
    ///
    /// # Errors
    /// The system's error when they cannot be sent.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// An open line, and its name.
pub(crate) type OpenedLine = (String, Box<dyn Transport>);

/// Source of a line: a serial port, or an emulated board.
pub trait Source: Send {
    /// Opens the line and returns its name and the line. Further calls, where [`can_reconnect`](Self::can_reconnect) is true,
    /// look for the same board.
    ///
    /// # Errors
    /// [`LinkError`] where no line can be opened.
    fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError>;

    /// True where a lost line may come back, as with a cable.
    fn can_reconnect(&self) -> bool;
}
