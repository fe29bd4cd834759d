//! Errors of the flash.

/// Errors of an operation on the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The region is empty, not of whole pages, or outside the flash.
    #[error("a region is of whole pages of 256 bytes within 0x80000..0x100000")]
    Region,
    /// The region overlaps the running program.
    #[error("the region overlaps the program: choose a higher one")]
    Program,
    /// Offset and length are not within the region.
    #[error("offset and length are not within the region")]
    OutOfBounds,
    /// The page's lock bit is set.
    #[error("the page is locked: unlock its lock region")]
    Locked,
    /// The controller refused the command.
    #[error("the flash controller refused the command")]
    Command,
    /// The controller did not become ready.
    #[error("the flash controller did not become ready")]
    Timeout,
}
