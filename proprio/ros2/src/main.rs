//! The program `proprio-ros2`: a live arm as a node of ROS 2.
//!
//! The messages are those of the live stream for viewers, to the byte. They come from a board, or from the stream of a running
//! `proprio monitor --foxglove` or `proprio record --foxglove`.
//!
//! | file | purpose |
//! |---|---|
//! | `board.rs`, `stream.rs` | the messages of a board; those of a stream |
//! | `node.rs` | the node: its participant of DDS, and a writer for each topic |
//! | `discovery_info.rs` | the message by which other nodes find its name |
//! | `names.rs` | names of topics and types on the wire |
//! | `environment.rs` | environment variables of ROS 2 |
//! | `error.rs` | errors, and their remedies |

mod board;
mod discovery_info;
mod environment;
mod error;
mod names;
mod node;
mod stream;

use std::process::ExitCode;

use clap::Parser;
use proprio::{LinkArgs, LiveArm, STYLES, ShutdownGuard, eprint_line, run_command, warn};

use environment::Environment;
use error::Error;
use node::Node;

/// Publish a live arm on the topics of ROS 2.
///
/// The arm is that of a board; of the running monitor that has the board's line and streams (--foxglove); or with --virtual an
/// emulated one. `ROS_DOMAIN_ID`, `ROS_AUTOMATIC_DISCOVERY_RANGE`, `ROS_LOCALHOST_ONLY` and `ROS_DISTRO` are used as by any node.
#[derive(Debug, Parser)]
#[command(version, styles = STYLES, max_term_width = 100)]
#[command(
    after_help = "Exit status: 0 done (Ctrl-C), 2 the command cannot be used or the arm is gone, 1 a fault of proprio itself."
)]
struct Arguments {
    /// Stream of a running `proprio monitor` or `record` with --foxglove, on this machine or through a tunnel [default: 127.0.0.1:8765]
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:8765")]
    #[arg(conflicts_with_all = ["port", "emulated", "table"])]
    stream: Option<String>,
    #[command(flatten)]
    link: LinkArgs,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run_command(|| run(&arguments), |error| matches!(error, Error::Arm(error) if error.is_fault())).into()
}

fn run(arguments: &Arguments) -> Result<u8, Error> {
    let environment = Environment::read()?;
    let shutdown = ShutdownGuard::new();
    let live_arm = match &arguments.stream {
        Some(address) => LiveArm::Stream(address.clone()),
        None => LiveArm::open(&arguments.link)?,
    };
    let mut node = Node::new(&environment)?;
    eprint_line(&format_args!("node {} of ROS 2, {environment}; Ctrl-C ends", node::NAME));
    match live_arm {
        LiveArm::Board(board) => board::publish(&board, &mut node, &shutdown)?,
        LiveArm::Stream(address) => stream::publish(&address, &mut node, &shutdown)?,
    }
    if node.unsent > 0 {
        warn(&format_args!("{} messages were not sent: subscribers were too slow", node.unsent));
    }
    Ok(0)
}
