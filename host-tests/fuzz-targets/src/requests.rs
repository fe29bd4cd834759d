//! A host's requests: the board's decoder, its command server, and the parts that commands act on.
//!
//! An input is a sequence of parts, by their first byte: bytes as they are received, the frame of a body, ticks without
//! a request, or the last frame again.

use board_core::{Actuator, CommandServer, Execution, Schedule, TableServer, VENTED_MS};
use board_table::Wiring;
use telemetry::{
    Actuation, Command, Decoder, PROTOCOL_VERSION, Refusal, Reply, Request, RequestOutcome, TICK_US, topic,
};

use crate::frames::{expected, frame_of, reference};
use crate::parts::Parts;
use crate::ram_flash::RamFlash;

/// Segments of the arm.
const SEGMENTS: usize = 6;

/// Number of the boot.
const BOOT: u32 = 1;

/// Ticks from the last accepted set-points after which no pressure is left.
const VENTED_TICKS: u32 = (VENTED_MS as u64 * 1000 / TICK_US) as u32 + 1;

/// Feeds a board with bytes, frames and time.
///
/// # Panics
/// Where a request is executed that is in no valid frame, for the second time, out of order, or in another session; where a
/// `Disarm` leaves pressures; where pressures stay after their deadline or exceed a regulator's full scale; and where a
/// reply is not that of its request.
pub fn requests(bytes: &[u8]) {
    let (mut board, mut parts, mut last) = (Board::new(), Parts::new(bytes), Vec::new());
    while let Some(kind) = parts.byte().filter(|_| !board.restarts) {
        match kind % 4 {
            0 => board.receive(parts.sized()),
            1 => {
                last = frame_of(PROTOCOL_VERSION, topic::REQUEST, parts.sized()).unwrap_or_default();
                board.receive(&last);
            }
            2 => (0..parts.byte().unwrap_or(1)).for_each(|_| board.pass_tick()),
            _ => board.receive(&last),
        }
    }
}

/// The board, as the firmware joins its parts.
struct Board {
    decoder: Decoder<Request>,
    /// The bytes since the last zero.
    block: Vec<u8>,
    server: CommandServer,
    parts: BoardParts,
    /// Session and number of the last executed request but a `Disarm`.
    last: Option<(u16, u32)>,
    tick: u32,
    restarts: bool,
}

/// The parts that commands act on.
struct BoardParts {
    actuator: Actuator,
    full_scale_pa: Vec<u32>,
    schedule: Schedule,
    table: TableServer<RamFlash>,
    /// Request that the table's task executes next.
    for_table: Option<Request>,
    /// Tick of the last accepted set-points.
    set: Option<u32>,
}

impl Board {
    fn new() -> Self {
        let wiring = Wiring::reference(SEGMENTS);
        let parts = BoardParts {
            actuator: Actuator::new(&wiring),
            full_scale_pa: wiring.regulators.iter().map(|regulator| regulator.full_scale_pa).collect(),
            schedule: Schedule::of_arm(SEGMENTS, wiring.regulators.len()),
            table: TableServer::new(RamFlash::new()),
            for_table: None,
            set: None,
        };
        let (decoder, server) = (Decoder::new(), CommandServer::new(BOOT));
        Self { decoder, block: Vec::new(), server, parts, last: None, tick: 0, restarts: false }
    }

    fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let request = self.decoder.push(*byte).and_then(Result::ok);
            if *byte != 0 {
                self.block.push(*byte);
                assert_eq!(request, None, "a frame ends with its zero");
                continue;
            }
            let valid = expected(reference(&self.block).as_deref()).ok();
            self.block.clear();
            assert_eq!(request, valid, "the frame's request, and nothing else");
            if let Some(request) = request {
                self.answer(&request);
            }
        }
    }

    fn answer(&mut self, request: &Request) {
        let mut executed = None;
        let (tick, parts) = (self.tick, &mut self.parts);
        let reply = self.server.answer(request, tick, |command| {
            assert_eq!(*command, request.command);
            let result = parts.execute(request, tick);
            executed = Some(result);
            result
        });
        if let Some(reply) = reply {
            assert_eq!((reply.id, reply.session), (request.id, self.server.session()));
        }
        if request.command == Command::Disarm {
            assert_eq!(self.parts.actuator.state(), Actuation::Disarmed, "a Disarm is always executed");
        } else if let Some(result) = executed {
            self.check_executed(request, result);
        }
        self.parts.check(self.tick);
    }

    fn check_executed(&mut self, request: &Request, result: Result<Execution, Refusal>) {
        let session = self.server.session();
        assert!(request.command == Command::Ping || request.session == session, "a request of another session");
        let is_new = self.last.is_none_or(|(before, id)| before != session || id < request.id);
        assert!(is_new, "request {} after {:?}", request.id, self.last);
        self.last = Some((session, request.id));
        self.restarts |= request.command == Command::Reboot && result.is_ok();
    }

    fn pass_tick(&mut self) {
        self.tick += 1;
        if let Some(request) = self.parts.for_table.take() {
            let result = self.parts.table.execute(&request.command);
            let outcome =
                result.as_ref().map_or_else(|refusal| RequestOutcome::Nack(*refusal), |_| RequestOutcome::Ack);
            self.server.complete(Reply { id: request.id, session: request.session, outcome });
            self.restarts |= result.is_ok_and(|answer| answer.restart);
        }
        self.parts.actuator.advance(u64::from(self.tick) * TICK_US);
        self.parts.schedule.due(self.tick);
        self.parts.check(self.tick);
    }
}

impl BoardParts {
    fn execute(&mut self, request: &Request, tick: u32) -> Result<Execution, Refusal> {
        match &request.command {
            Command::Ping | Command::Tare(_) => {}
            Command::Rates(rates) => self.schedule.set(*rates),
            Command::Arm => self.actuator.arm(),
            Command::Disarm | Command::Reboot => self.actuator.disarm(),
            Command::SetPressures(pressures) => {
                let accepted = self.actuator.set(pressures, u64::from(tick) * TICK_US);
                self.set = accepted.is_ok().then_some(tick).or(self.set);
                return accepted;
            }
            _ if self.for_table.is_some() => return Err(Refusal::Busy),
            _ => {
                self.for_table = Some(request.clone());
                return Ok(Execution::Pending);
            }
        }
        Ok(Execution::Done)
    }

    fn check(&self, tick: u32) {
        let pressures = self.actuator.pressures_pa();
        assert_eq!(pressures.len(), self.full_scale_pa.len());
        assert!(pressures.iter().zip(&self.full_scale_pa).all(|(pressure, most)| pressure <= most));
        let is_leased = self.set.is_some_and(|set| tick - set < VENTED_TICKS);
        if self.actuator.state() == Actuation::Disarmed || !is_leased {
            assert!(pressures.iter().all(|pressure| *pressure == 0), "pressures without valid set-points");
        }
    }
}
