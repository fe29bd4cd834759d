//! Command task: decodes the host's requests, executes them and replies.

use atsam3x8e_hal::tc::Mono;
use atsam3x8e_hal::uart::Rx;
use board_core::{Actuator, CommandServer, Execution, REST_RANGE, Schedule, Task};
use rtic::Mutex;
use rtic_sync::channel::Sender;
use telemetry::{
    Actuation, Command, Counts, DecodeError, Decoder, Message, Refusal, Reply, Request, RequestOutcome, TareMode,
    TareReport,
};

use crate::downlink::TelemetrySender;
use crate::parameters::RECEIVE_BYTES;
use crate::supervision::SUPERVISOR;

/// Requests that wait for the table task. A host sends pieces of a table ahead, so that the line is never idle.
pub const TABLE_REQUESTS: usize = 4;

/// Pose of the arm, as a request to tare reports it.
#[derive(Clone, Copy, Default)]
pub struct Pose {
    /// Segment whose heading turned most, and its range in units of 2⁻²⁶ rad.
    pub turned: Option<(u8, i32)>,
    /// Segment that is bent most by its bend sensors, and its angle in units of 2⁻²⁶ rad.
    pub bent: Option<(u8, i32)>,
}

/// State that requests set for the other tasks.
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct Control {
    /// Periods of the messages.
    pub schedule: Schedule,
    /// A tare was requested.
    pub tare_requested: bool,
    /// Pose of the arm in the last tick.
    pub pose: Pose,
    /// Report on a request to tare, to be sent.
    pub tare_report: Option<TareReport>,
    /// A `Hello` was requested.
    pub hello_requested: bool,
    /// Frames received since boot.
    pub received: Counts,
    /// The board has a valid table.
    pub has_table: bool,
    /// A boot loop: the pressures stay at zero.
    pub safe_mode: bool,
    /// Reply of the table task, already sent.
    pub completed: Option<Reply>,
}

impl Control {
    /// Lets the pose at the request of this number be reported.
    fn report_pose(&mut self, id: u32) {
        let Pose { turned, bent } = self.pose;
        self.tare_report = Some(TareReport { id, turned, bent });
    }
}

/// State of the command task.
pub struct CommandTask {
    rx: Rx,
    decoder: Decoder<Request>,
    server: CommandServer,
    to_table: Sender<'static, Request, TABLE_REQUESTS>,
}

impl CommandTask {
    /// The task before its first byte, in the boot of this number.
    pub const fn new(rx: Rx, to_table: Sender<'static, Request, TABLE_REQUESTS>, boot: u32) -> Self {
        Self { rx, decoder: Decoder::new(), server: CommandServer::new(boot), to_table }
    }

    /// Handles the bytes since the last tick. Returns whether a reboot was requested.
    pub fn run(
        &mut self,
        tick: u32,
        mut actuator: impl Mutex<T = Actuator>,
        mut control: impl Mutex<T = Control>,
        mut sender: impl Mutex<T = TelemetrySender>,
    ) -> bool {
        let mut reboot = false;
        if let Some(reply) = control.lock(|control| control.completed.take()) {
            self.server.complete(reply);
        }
        let mut bytes = [0; RECEIVE_BYTES];
        let count = self.rx.read(&mut bytes);
        for byte in bytes.iter().take(count) {
            let reply = match self.decoder.push(*byte) {
                Some(Ok(request)) => self.server.answer(&request, tick, |command| {
                    let result = if is_about_table(command) {
                        let may_change = actuator.lock(|actuator| actuator.state() == Actuation::Disarmed);
                        send_to_table_task(&request, may_change, &mut self.to_table)
                    } else {
                        control
                            .lock(|control| actuator.lock(|actuator| execute(command, actuator, control, &mut reboot)))
                    };
                    if matches!(command, Command::Tare(_)) {
                        control.lock(|control| control.report_pose(request.id));
                    }
                    log(&request, result);
                    result
                }),
                Some(Err(DecodeError::Request(id))) => {
                    let session = self.server.session();
                    Some(Reply { id, session, outcome: RequestOutcome::Nack(Refusal::Unknown) })
                }
                Some(Err(_)) | None => None,
            };
            if let Some(reply) = reply {
                sender.lock(|sender| sender.send(&Message::Reply(reply)));
            }
        }
        let received = self.decoder.counts();
        control.lock(|control| control.received = received);
        SUPERVISOR.report(Task::Commands, tick);
        reboot
    }
}

/// Returns whether the table task executes a command.
const fn is_about_table(command: &Command) -> bool {
    matches!(
        command,
        Command::TableBegin(_)
            | Command::TableWrite(_)
            | Command::TableCommit
            | Command::TableErase
            | Command::TableRead(_)
    )
}

/// Sends a request about the table to its task. Only the reading of the table is admitted while the pressures are armed.
fn send_to_table_task(
    request: &Request,
    may_change: bool,
    to_table: &mut Sender<'static, Request, TABLE_REQUESTS>,
) -> Result<Execution, Refusal> {
    if !may_change && !matches!(request.command, Command::TableRead(_)) {
        return Err(Refusal::Armed);
    }
    to_table.try_send(request.clone()).map(|()| Execution::Pending).map_err(|_| Refusal::Busy)
}

fn execute(
    command: &Command,
    actuator: &mut Actuator,
    control: &mut Control,
    reboot: &mut bool,
) -> Result<Execution, Refusal> {
    match command {
        Command::Ping => control.hello_requested = true,
        Command::Tare(TareMode::IfStill) if control.pose.turned.is_some_and(|(_, range)| range > REST_RANGE) => {
            return Err(Refusal::Moving);
        }
        Command::Tare(_) => control.tare_requested = true,
        Command::Rates(rates) => control.schedule.set(*rates),
        Command::Arm if control.safe_mode => return Err(Refusal::SafeMode),
        Command::Arm if !control.has_table => return Err(Refusal::NoTable),
        Command::Arm => actuator.arm(),
        Command::Disarm => actuator.disarm(),
        Command::SetPressures(pressures) => return actuator.set(pressures, Mono::now_us()),
        Command::Reboot => {
            actuator.disarm();
            *reboot = true;
        }
        _ => return Err(Refusal::Unknown),
    }
    Ok(Execution::Done)
}

/// Logs an executed request; those that are sent many times a second at the level debug alone.
fn log(request: &Request, result: Result<Execution, Refusal>) {
    match (result, &request.command) {
        (Ok(_), Command::SetPressures(_) | Command::TableWrite(_) | Command::TableRead(_)) => {
            defmt::debug!("{}", request);
        }
        (Ok(_), _) => defmt::info!("{}", request),
        (Err(refusal), _) => defmt::warn!("request {} refused: {}", request.id, refusal),
    }
}
