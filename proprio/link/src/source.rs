//! Where a line to a board comes from.

use std::io;

use super::LinkError;

/// An open line.
pub trait Transport: Send {
    /// Takes what has come, or waits some milliseconds for it; 0: nothing came.
    ///
    /// # Errors
    /// What the system says when the line is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Sends bytes, all of them.
    ///
    /// # Errors
    /// What the system says when they cannot be sent.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// What opens lines.
pub trait Source: Send {
    /// Opens the line, and gives it with its name. Called again where [`comes_back`](Self::comes_back) says so, it looks
    /// for the same board.
    ///
    /// # Errors
    /// [`LinkError`]: why there is none.
    fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError>;

    /// Whether a line that was lost may come back, as a cable does.
    fn comes_back(&self) -> bool;
}
