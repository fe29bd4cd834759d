//! Errors of images and of the store.

/// Reason why a table is not stored, or an image not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// The image is longer than the room for it.
    #[error("the table is longer than its place on the board")]
    TooLong,
    /// The bytes are no image of this format.
    #[error("the table's image cannot be read")]
    Image,
    /// The arm has no segment, or more than the board's estimator has room for.
    #[error("the arm has no segment, or more than the board's estimator has room for")]
    Segments,
    /// The anchor's window is empty, or longer than the board's estimator has room for.
    #[error("the anchor's window is empty, or longer than the board's estimator has room for")]
    Window,
    /// A chunk or a commit without a transfer under way.
    #[error("no transfer is under way")]
    NotBegun,
    /// A chunk does not follow the one before it, or exceeds the announced length.
    #[error("a chunk does not follow the one before it")]
    Order,
    /// The transfer is not complete.
    #[error("the transfer is not complete")]
    Incomplete,
    /// The checksum of what was stored is not the announced one.
    #[error("the checksum of the stored table is wrong")]
    Checksum,
    /// The flash did not take what was written.
    #[error("the flash did not take what was written")]
    Flash,
}
