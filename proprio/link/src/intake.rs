//! Bytes to messages, and what they tell of restarts, losses and mismatches.

use proprio_session::{BootTracker, Continuity, is_version_0_1};
use telemetry::{Counts, DecodeError, Decoder, Hello, Message, is_same_layout};

use super::event::Mismatch;

/// What came of one byte.
#[derive(Debug, Clone, PartialEq)]
pub enum Taken {
    /// A message.
    Message(Message),
    /// A frame that is no message.
    Undecoded(DecodeError),
    /// The board has restarted; the message that shows it follows.
    Restarted,
    /// Board and host do not belong together.
    Mismatch(Mismatch),
}

/// The receiving side of a line, over all the times that it was opened.
#[derive(Debug, Default)]
pub struct Intake {
    decoder: Decoder<Message>,
    /// Of the times that the line was open before.
    before: Counts,
    /// The decoder's losses at the first `Hello` since the line was opened; what is counted before may be the gap between
    /// two runs of the board.
    losses_begin: Option<u32>,
    hello: Option<Hello>,
    runs: BootTracker,
    restarts: u32,
    table: Option<u32>,
    mismatches: Vec<Mismatch>,
}

impl Intake {
    /// Knows the checksum of the table that the board should have, if there is one.
    #[must_use]
    pub fn new(table: Option<u32>) -> Self {
        Self { table, ..Self::default() }
    }

    /// The line is opened (again): frames are counted anew.
    pub fn open(&mut self) {
        self.before = self.counts();
        self.decoder = Decoder::new();
        self.losses_begin = None;
        self.runs.opened();
    }

    /// What was received since the beginning. Losses count from the first `Hello` after each opening.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let now = self.decoder.counts();
        let lost = self.losses_begin.map_or(0, |begin| now.lost.saturating_sub(begin));
        Counts {
            received: self.before.received.saturating_add(now.received),
            damaged: self.before.damaged.saturating_add(now.damaged),
            lost: self.before.lost.saturating_add(lost),
            wrong_version: self.before.wrong_version.saturating_add(now.wrong_version),
            unknown: self.before.unknown.saturating_add(now.unknown),
        }
    }

    /// The board's last `Hello`.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// How often the board has restarted since its first `Hello`.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// In what board and host differ, as far as is known.
    #[must_use]
    pub fn mismatches(&self) -> &[Mismatch] {
        &self.mismatches
    }

    /// Takes one byte and tells what it completes.
    pub fn push(&mut self, byte: u8, mut tell: impl FnMut(Taken)) {
        match self.decoder.push(byte) {
            Some(Ok(Message::Hello(hello))) => self.greet(hello, &mut tell),
            Some(Ok(message)) if self.is_trusted() => {
                if let Message::Sample(sample) = &message
                    && self.runs.sample(sample.tick) == Continuity::Restarted
                {
                    self.restart(&mut tell);
                }
                tell(Taken::Message(message));
            }
            // No frame is complete; or its form may mean something else.
            None | Some(Ok(_)) => {}
            Some(Err(error)) => {
                match error {
                    DecodeError::Version(version) => self.mismatch(Mismatch::Protocol(version), &mut tell),
                    DecodeError::Body(_) if self.hello.is_none() => {
                        self.mismatch(Mismatch::Schema { board: None, firmware: None }, &mut tell);
                    }
                    _ => {}
                }
                tell(Taken::Undecoded(error));
            }
        }
    }

    fn is_trusted(&self) -> bool {
        self.hello.as_ref().is_none_or(|hello| is_same_layout(hello.schema))
    }

    fn greet(&mut self, hello: Hello, tell: &mut impl FnMut(Taken)) {
        self.losses_begin.get_or_insert(self.decoder.counts().lost);
        if self.runs.hello(hello.boot) {
            self.restart(tell);
        }
        let firmware = hello.firmware.as_str().to_owned();
        if !is_same_layout(hello.schema) {
            self.mismatch(Mismatch::Schema { board: Some(hello.schema), firmware: Some(firmware) }, tell);
        } else if firmware != env!("CARGO_PKG_VERSION") {
            self.mismatch(Mismatch::Firmware(firmware), tell);
        }
        // Firmware of version 0.1 has another checksum of the same table.
        let is_comparable = !is_version_0_1(&hello.firmware);
        if let Some(given) = self.table.filter(|given| is_comparable && *given != hello.table) {
            let arm = hello.arm.as_str().to_owned();
            self.mismatch(Mismatch::Table { arm, board: hello.table, given }, tell);
        }
        self.hello = Some(hello.clone());
        tell(Taken::Message(Message::Hello(hello)));
    }

    fn restart(&mut self, tell: &mut impl FnMut(Taken)) {
        self.restarts += 1;
        tell(Taken::Restarted);
    }

    /// Each is told once.
    fn mismatch(&mut self, mismatch: Mismatch, tell: &mut impl FnMut(Taken)) {
        if !self.mismatches.contains(&mismatch) {
            self.mismatches.push(mismatch.clone());
            tell(Taken::Mismatch(mismatch));
        }
    }
}
