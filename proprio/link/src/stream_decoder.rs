//! Bytes to messages, and the restarts, losses and mismatches that they show.

use proprio_session::{BootTracker, Continuity, is_version_0_1};
use telemetry::{Counts, DecodeError, Decoder, Hello, Message, is_same_layout};

use super::event::Mismatch;

/// A part of the stream that is complete.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "almost all are messages: a box of each would cost more than it saves")]
pub enum Received {
    /// A message.
    Message(Message),
    /// A frame that is not a valid message.
    Undecoded(DecodeError),
    /// The board has restarted; the message that shows it follows.
    Restarted,
    /// Board and host are not of the same release or table.
    Mismatch(Mismatch),
}

/// Decoder of a line's stream, over all the times that the line is opened.
#[derive(Debug, Default)]
pub struct StreamDecoder {
    decoder: Decoder<Message>,
    is_opened: bool,
    /// Counts of the earlier times that the line was open.
    before: Counts,
    /// The decoder's losses at the first `Hello` since the line was opened; losses counted before that may be the gap
    /// between two runs of the board.
    losses_begin: Option<u32>,
    /// Gaps in the stream until the line was opened.
    gaps_before: u32,
    hello: Option<Hello>,
    runs: BootTracker,
    restarts: u32,
    table: Option<u32>,
    mismatches: Vec<Mismatch>,
}

impl StreamDecoder {
    /// A decoder that compares the board's table with the checksum `table`, where there is one.
    #[must_use]
    pub fn new(table: Option<u32>) -> Self {
        Self { table, ..Self::default() }
    }

    /// Resets the decoder when the line is opened (again).
    pub fn open(&mut self) {
        self.before = self.counts();
        // The frames between the loss of the line and now are a gap; the first opening is no gap.
        self.gaps_before = self.gaps().saturating_add(u32::from(self.is_opened));
        self.is_opened = true;
        self.decoder = Decoder::new();
        self.losses_begin = None;
        self.runs.opened();
    }

    /// Frames since the first opening. Losses count from the first `Hello` after each opening.
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

    /// Gaps in the stream: lost frames, also those before the first `Hello`, and openings of the line after the first.
    #[must_use]
    pub fn gaps(&self) -> u32 {
        self.gaps_before.saturating_add(self.decoder.counts().lost)
    }

    /// The board's last `Hello`.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Version of the protocol that the board uses, once a frame has come since the line was opened.
    #[must_use]
    pub fn version(&self) -> Option<u8> {
        self.decoder.version()
    }

    /// Restarts of the board since its first `Hello`.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// The differences between board and host that were found so far.
    #[must_use]
    pub fn mismatches(&self) -> &[Mismatch] {
        &self.mismatches
    }

    /// Takes one byte and passes the parts that it completes to `publish`.
    pub fn push(&mut self, byte: u8, mut publish: impl FnMut(Received)) {
        match self.decoder.push(byte) {
            Some(Ok(Message::Hello(hello))) => self.handshake(hello, &mut publish),
            Some(Ok(message)) if self.is_trusted() => {
                if let Message::Sample(sample) = &message
                    && self.runs.sample(sample.tick) == Continuity::Restarted
                {
                    self.restart(&mut publish);
                }
                publish(Received::Message(message));
            }
            // No frame is complete, or its layout is not known.
            None | Some(Ok(_)) => {}
            Some(Err(error)) => {
                match error {
                    DecodeError::Version(version) => self.mismatch(Mismatch::Protocol(version), &mut publish),
                    DecodeError::Body(_) if self.hello.is_none() => {
                        self.mismatch(Mismatch::Schema { board: None, firmware: None }, &mut publish);
                    }
                    _ => {}
                }
                publish(Received::Undecoded(error));
            }
        }
    }

    fn is_trusted(&self) -> bool {
        self.hello.as_ref().is_none_or(|hello| is_same_layout(hello.schema))
    }

    fn handshake(&mut self, hello: Hello, publish: &mut impl FnMut(Received)) {
        self.losses_begin.get_or_insert(self.decoder.counts().lost);
        if self.runs.hello(hello.boot) {
            self.restart(publish);
        }
        let firmware = hello.firmware.as_str().to_owned();
        if !is_same_layout(hello.schema) {
            self.mismatch(Mismatch::Schema { board: Some(hello.schema), firmware: Some(firmware) }, publish);
        } else if firmware != env!("CARGO_PKG_VERSION") {
            self.mismatch(Mismatch::Firmware(firmware), publish);
        }
        // Firmware of version 0.1 has another checksum of the same table.
        let is_comparable = !is_version_0_1(&hello.firmware);
        if self.table == Some(hello.table) {
            // A table that was stored since.
            self.mismatches.retain(|mismatch| !mismatch.is_table());
        }
        if let Some(given) = self.table.filter(|given| is_comparable && *given != hello.table) {
            let arm = hello.arm.as_str().to_owned();
            self.mismatch(Mismatch::Table { arm, board: hello.table, given }, publish);
        }
        self.hello = Some(hello.clone());
        publish(Received::Message(Message::Hello(hello)));
    }

    fn restart(&mut self, publish: &mut impl FnMut(Received)) {
        self.restarts += 1;
        publish(Received::Restarted);
    }

    /// Publishes each mismatch once.
    fn mismatch(&mut self, mismatch: Mismatch, publish: &mut impl FnMut(Received)) {
        if !self.mismatches.contains(&mismatch) {
            self.mismatches.push(mismatch.clone());
            publish(Received::Mismatch(mismatch));
        }
    }
}
