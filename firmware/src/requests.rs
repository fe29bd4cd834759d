//! The host's requests: bytes in, deeds and answers out.

use atsam3x8e_hal::tc::Mono;
use atsam3x8e_hal::uart::Rx;
use board_core::{Actuator, Link, Schedule, Task};
use rtic::Mutex;
use telemetry::{Command, DecodeError, Decoder, Message, Outcome, Refusal, Reply, Request};

use crate::SUPERVISOR;
use crate::parameters::RECEIVE_BYTES;
use crate::voice::Voice;

/// What requests change of the other tasks.
pub struct Control {
    /// What is sent when.
    pub schedule: Schedule,
    /// A tare is asked for.
    pub tare: bool,
    /// Who the board is shall be said.
    pub hello: bool,
    /// Frames since boot that came damaged.
    pub damaged_frames: u32,
}

/// What the requests' task needs.
pub struct Requests {
    rx: Rx,
    decoder: Decoder<Request>,
    link: Link,
}

impl Requests {
    /// Nothing came yet.
    pub const fn new(rx: Rx) -> Self {
        Self { rx, decoder: Decoder::new(), link: Link::new() }
    }

    /// Takes what came since the last tick. Says whether the board shall restart.
    pub fn run(
        &mut self,
        tick: u32,
        mut actuator: impl Mutex<T = Actuator>,
        mut control: impl Mutex<T = Control>,
        mut voice: impl Mutex<T = Voice>,
    ) -> bool {
        let mut reboot = false;
        let mut bytes = [0; RECEIVE_BYTES];
        let count = self.rx.read(&mut bytes);
        for byte in bytes.iter().take(count) {
            let reply = match self.decoder.push(*byte) {
                Some(Ok(request)) => self.link.answer(&request, tick, |command| {
                    control.lock(|control| actuator.lock(|actuator| act(command, actuator, control, &mut reboot)))
                }),
                Some(Err(DecodeError::Request(id))) => Some(Reply { id, outcome: Outcome::Nack(Refusal::Unknown) }),
                Some(Err(_)) | None => None,
            };
            if let Some(reply) = reply {
                voice.lock(|voice| voice.say(&Message::Reply(reply)));
            }
        }
        let damaged = self.decoder.counts().damaged;
        control.lock(|control| control.damaged_frames = damaged);
        SUPERVISOR.report(Task::Link, tick);
        reboot
    }
}

fn act(command: Command, actuator: &mut Actuator, control: &mut Control, reboot: &mut bool) -> Result<(), Refusal> {
    match command {
        Command::Ping => control.hello = true,
        Command::Tare => control.tare = true,
        Command::Rates(rates) => control.schedule = Schedule::new(rates),
        Command::Arm => actuator.arm(),
        Command::Disarm => actuator.disarm(),
        Command::SetPressures(pressures) => actuator.set(&pressures, Mono::now_us())?,
        Command::Reboot => {
            actuator.disarm();
            *reboot = true;
        }
    }
    Ok(())
}
