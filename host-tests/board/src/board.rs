//! A board that runs the firmware, and a host at its serial line.

use rig_twin::{EndPose, MotionProgram, PerSegment};
use telemetry::{
    Command, Decoder, Encoder, Estimate, Event, Health, Hello, MAX_FRAME, Message, Request, RequestOutcome, Sample,
    SetPressures, TableState, Uncertainty,
};
use virtual_due::{CYCLES_PER_SECOND, Cycles, Machine, WiredRig};

use crate::build::firmware;
use crate::flash::machine;

/// The serial port of the programming port: the UART.
pub const UART: usize = 0;

/// Pressure of a regulator at full duty, Pa.
const FULL_SCALE_PA: u32 = 280_000;

/// A message, and when its last byte left the board.
#[derive(Debug, Clone, PartialEq)]
pub struct Received {
    /// End of its last byte.
    pub at: Cycles,
    /// The message.
    pub message: Message,
}

/// The board, and all messages that it has sent.
pub struct Board {
    /// The emulated board.
    pub machine: Machine<WiredRig>,
    decoder: Decoder<Message>,
    encoder: Encoder,
    next_id: u32,
    /// The board's session, and the time of the last request in it.
    session: u16,
    requested_at: Option<Cycles>,
    received: Vec<Received>,
    bytes: u64,
    scans: u64,
    truths: Vec<PerSegment<EndPose>>,
}

impl Board {
    /// A board with the firmware and the reference arm's table in its flash, in a rig, with power just come up.
    ///
    /// # Panics
    /// If the firmware does not build.
    #[must_use]
    pub fn new(rig: WiredRig) -> Self {
        Self::start(machine(rig))
    }

    /// A board with the firmware and this content of the rest of the flash.
    ///
    /// # Panics
    /// If the firmware does not build.
    #[must_use]
    pub fn with_flash(rig: WiredRig, flash: &[u8]) -> Self {
        let mut machine = Machine::new(firmware(), rig).expect("cargo built an ELF for the board");
        machine.load_flash(flash);
        Self::start(machine)
    }

    fn start(machine: Machine<WiredRig>) -> Self {
        Self {
            machine,
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            next_id: 1,
            session: 0,
            requested_at: None,
            received: Vec::new(),
            bytes: 0,
            scans: 0,
            truths: Vec::new(),
        }
    }

    /// Begins a fault, by its name.
    ///
    /// # Panics
    /// If there is no such fault, or the board cannot have it.
    pub fn inject(&mut self, fault: &str) {
        self.machine.inject(fault.parse().expect("a fault")).expect("the board can have it");
    }

    /// Ends a fault, by its name.
    ///
    /// # Panics
    /// If there is no such fault.
    pub fn clear(&mut self, fault: &str) {
        self.machine.clear(fault.parse().expect("a fault"));
    }

    /// Runs the board, and receives its messages. A frame that a reset cut short is counted, and left out.
    pub fn run_ms(&mut self, ms: u64) {
        self.run_until(self.machine.now() + ms * CYCLES_PER_SECOND / 1000);
    }

    /// As [`run_ms`](Self::run_ms), up to a time since power-on.
    pub fn run_until(&mut self, end: Cycles) {
        while self.machine.now() < end {
            // Pieces shorter than a tick, so that no scan of the ADC is missed.
            self.machine.run_until(end.min(self.machine.now() + CYCLES_PER_SECOND / 200));
            let (scans, truth) = self.machine.world().last_scan();
            if scans > self.scans {
                self.scans = scans;
                self.truths.push(truth);
            }
        }
        for (at, byte) in self.machine.world_mut().take_transmitted(UART) {
            self.bytes += 1;
            if let Some(Ok(message)) = self.decoder.push(byte) {
                if let Message::Reply(reply) = message {
                    self.session = reply.session;
                }
                self.received.push(Received { at, message });
            }
        }
    }

    /// Takes the messages and the truths since the last call, so that a run of hours needs no more memory.
    pub fn take(&mut self) -> (Vec<Received>, Vec<PerSegment<EndPose>>) {
        (std::mem::take(&mut self.received), std::mem::take(&mut self.truths))
    }

    /// The true pose of each segment's end at each tick since power-on, or since [`take`](Self::take).
    #[must_use]
    pub fn truths(&self) -> &[PerSegment<EndPose>] {
        &self.truths
    }

    /// Sends a request once; returns its number.
    ///
    /// # Panics
    /// Never: every request fits a frame.
    pub fn send(&mut self, command: Command) -> u32 {
        let id = self.next_id;
        self.next_id += 1;
        self.requested_at = Some(self.machine.now());
        self.send_again(&Request { id, session: self.session, command });
        id
    }

    /// Begins a session by a Ping, before the first request and after a second without one.
    ///
    /// # Panics
    /// If the Ping is not acknowledged within 50 ms.
    pub fn begin_session(&mut self) {
        let now = self.machine.now();
        if self.requested_at.is_some_and(|at| now.saturating_sub(at) < CYCLES_PER_SECOND) {
            return;
        }
        let id = self.send(Command::Ping);
        self.run_ms(50);
        assert_eq!(self.outcome(id), Some(RequestOutcome::Ack), "a Ping is acknowledged within 50 ms");
    }

    /// Number of the session.
    #[must_use]
    pub const fn session(&self) -> u16 {
        self.session
    }

    /// The last reply to a request.
    fn outcome(&self, id: u32) -> Option<RequestOutcome> {
        self.received.iter().rev().find_map(|received| match received.message {
            Message::Reply(reply) if reply.id == id => Some(reply.outcome),
            _ => None,
        })
    }

    /// Sends a request with a number of its own.
    ///
    /// # Panics
    /// Never: every request fits a frame.
    pub fn send_again(&mut self, request: &Request) {
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(request, &mut buffer).expect("every request fits");
        let now = self.machine.now();
        let line = self.machine.world_mut();
        // Ends a frame that noise may have started.
        line.send(UART, &[0], now);
        line.send(UART, frame, now);
    }

    /// Sends a request; returns the answer.
    ///
    /// # Panics
    /// If none comes within 100 ms.
    pub fn request(&mut self, command: Command) -> RequestOutcome {
        self.begin_session();
        let id = self.send(command);
        self.run_ms(100);
        self.outcome(id).expect("a request is answered within 100 ms")
    }

    /// Arms, and lets the arm swing by the scenario's own program for some seconds, with set-points 20 times a second.
    ///
    /// # Panics
    /// If the board does not arm.
    pub fn swing(&mut self, program: &MotionProgram, seconds: u64) {
        assert_eq!(self.request(Command::Arm), RequestOutcome::Ack);
        let start = self.machine.seconds();
        for _ in 0..seconds * 20 {
            self.set_pressures(&program.duties(self.machine.seconds() - start));
            self.run_ms(50);
        }
    }

    /// Arms, and sets all regulators to a pressure for a second.
    ///
    /// # Panics
    /// If the board refuses.
    pub fn pressurise(&mut self, pressure_pa: u32) {
        assert_eq!(self.request(Command::Arm), RequestOutcome::Ack);
        let pressures_pa = [pressure_pa; 6].into_iter().collect();
        let set = Command::SetPressures(SetPressures { pressures_pa, valid_ms: 1000 });
        assert_eq!(self.request(set), RequestOutcome::Ack);
    }

    /// Sends set-points that stand for 200 ms, as shares of the full scale.
    pub fn set_pressures(&mut self, duties: &[f64]) {
        let pressure_pa = |duty: &f64| (duty * f64::from(FULL_SCALE_PA)) as u32;
        let pressures_pa = duties.iter().map(pressure_pa).collect();
        self.send(Command::SetPressures(SetPressures { pressures_pa, valid_ms: 200 }));
    }

    /// True if no regulator is commanded any pressure.
    #[must_use]
    pub fn is_vented(&self) -> bool {
        self.machine.world().set_points_pa().iter().all(|pressure_pa| *pressure_pa < 1.0)
    }

    /// All received messages, in order.
    #[must_use]
    pub fn received(&self) -> &[Received] {
        &self.received
    }

    /// Number of bytes received.
    #[must_use]
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Counts of the decoder.
    #[must_use]
    pub const fn counts(&self) -> telemetry::Counts {
        self.decoder.counts()
    }

    /// All samples, in order.
    pub fn samples(&self) -> impl DoubleEndedIterator<Item = &Sample> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Sample(sample) => Some(sample),
            _ => None,
        })
    }

    /// All estimates, in order.
    pub fn estimates(&self) -> impl DoubleEndedIterator<Item = &Estimate> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Estimate(estimate) => Some(estimate),
            _ => None,
        })
    }

    /// All uncertainties, in order.
    pub fn uncertainties(&self) -> impl DoubleEndedIterator<Item = &Uncertainty> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Uncertainty(uncertainty) => Some(uncertainty),
            _ => None,
        })
    }

    /// All health messages, in order.
    pub fn healths(&self) -> impl DoubleEndedIterator<Item = &Health> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Health(health) => Some(health),
            _ => None,
        })
    }

    /// All events, in order.
    pub fn events(&self) -> impl DoubleEndedIterator<Item = Event> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Event(event) => Some(*event),
            _ => None,
        })
    }

    /// All states of the table, in order.
    pub fn table_states(&self) -> impl DoubleEndedIterator<Item = &TableState> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Table(state) => Some(state),
            _ => None,
        })
    }

    /// All `Hello` messages, in order.
    pub fn hellos(&self) -> impl DoubleEndedIterator<Item = &Hello> {
        self.received.iter().filter_map(|received| match &received.message {
            Message::Hello(hello) => Some(hello),
            _ => None,
        })
    }
}
