//! Errors of a fault's name, its time, and its place.

/// A fault that cannot be injected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FaultError {
    /// The name has no such form, or its device does not exist.
    #[error("unknown fault `{0}`, expected a device and its fault, such as imu3:reset or bend2a:factor=1.3")]
    Name(String),
    /// A fault without the value that it needs, or with a value out of range.
    #[error("fault `{name}`: expected a value of {low} to {high}{unit}, such as {example}")]
    Value {
        /// The name as it was given.
        name: String,
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
        /// Unit of the value, after a space; empty for a factor.
        unit: String,
        /// A valid name.
        example: String,
    },
    /// A value of a fault that has none.
    #[error("fault `{0}` has no value")]
    NoValue(String),
    /// A begin or a duration that is no time.
    #[error("`{0}`: expected seconds, and a duration after a plus sign, such as 12.5 or 12.5+0.05")]
    Time(String),
    /// A fault without its begin.
    #[error("`{0}`: expected the fault and its begin in s, such as imu3:reset@12.5")]
    NoBegin(String),
    /// A line of a schedule without its two words.
    #[error("`{0}`: expected the begin in s and the fault, such as `12.5 imu3:reset`")]
    Line(String),
    /// A duration of a fault that happens at an instant.
    #[error("fault `{0}` happens at an instant, and has no duration")]
    Instant(String),
    /// A sensor that the arm does not have.
    #[error("fault `{0}`: the arm has no such sensor")]
    NotOnArm(String),
    /// A fault of the board, in a session that has none.
    #[error("fault `{0}` has no meaning for a session: it acts on the emulated board (`virtual-due run --faults`)")]
    NotInSession(String),
    /// A place of the chip that does not exist.
    #[error("fault `{0}`: the chip has no such place")]
    NotOnChip(String),
}
