//! Errors that end the program, and their remedies.

use proprio::Help;
use proprio_link::LinkError;

/// An error that ends the program.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The arm cannot be reached.
    #[error(transparent)]
    Arm(#[from] proprio::Error),
    /// An environment variable has a value that this program cannot follow.
    #[error("{name}={value}, expected {expected}")]
    Environment { name: &'static str, value: String, expected: &'static str },
    /// The node cannot be made.
    #[error("the node cannot be made: {0}")]
    Node(#[from] rustdds::dds::CreateError),
    /// The node cannot send any more.
    #[error("the node cannot send any more: {0}")]
    Write(String),
    /// A stream cannot be read.
    #[error("ws://{address}: {reason}")]
    Stream { address: String, reason: String },
}

impl From<LinkError> for Error {
    fn from(error: LinkError) -> Self {
        Self::Arm(error.into())
    }
}

impl Help for Error {
    fn help(&self) -> String {
        let help = match self {
            Self::Arm(error) => return error.help(),
            Self::Environment { .. } => "set it as for the other nodes, or unset it",
            Self::Node(_) => "check that the network is up, and that ROS_DOMAIN_ID is that of the other nodes",
            Self::Write(_) => "start it again",
            Self::Stream { .. } => {
                "start `proprio monitor --foxglove` or `proprio record --foxglove`, and give the address that it prints: --stream=HOST:PORT"
            }
        };
        help.to_owned()
    }
}
