//! Errors of images, of the store and of wirings.

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
    /// The wiring does not fit the board or the table.
    #[error("the wiring: {0}")]
    Wiring(WiringError),
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

/// Reason why a wiring cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WiringError {
    /// It has no segment, or not those of the table.
    #[error("it has no segment, or not as many as the table")]
    Segments,
    /// An analog pin that the board does not have.
    #[error("A{0} is no analog pin of the board, which has A0 to A11")]
    UnknownAnalogPin(u8),
    /// Two bend sensors on one analog pin.
    #[error("two bend sensors are on pin A{0}")]
    SharedAnalogPin(u8),
    /// A channel or an address that no IMU can have.
    #[error(
        "no IMU can be on channel {channel} at address {address:#04x}: channels are 0 to 7, addresses 0x28 and 0x29"
    )]
    UnknownImuAddress {
        /// Channel of the multiplexer.
        channel: u8,
        /// I²C address.
        address: u8,
    },
    /// Two IMUs with the same channel and address.
    #[error("two IMUs are on channel {channel} at address {address:#04x}")]
    SharedImuAddress {
        /// Channel of the multiplexer.
        channel: u8,
        /// I²C address.
        address: u8,
    },
    /// A digital pin without a PWM channel.
    #[error("D{0} has no PWM channel; D6, D7, D8, D9, D34, D36, D38 and D40 have one")]
    PinWithoutPwm(u8),
    /// Two regulators on one pin.
    #[error("two regulators are on pin D{0}")]
    SharedRegulatorPin(u8),
    /// A regulator, given by its pin, has a full scale of 0 or more than 1 MPa.
    #[error("the full scale of the regulator on D{0} is not within 1 Pa and 1 MPa")]
    FullScale(u8),
}
