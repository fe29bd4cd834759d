//! The receiving side: bytes in, in any cut, and messages out.

use core::marker::PhantomData;

use heapless::Vec;

use crate::frame::{Frame, MAX_FRAME, PROTOCOL_VERSION};
use crate::payload::Payload;

/// Why a frame gave no message. The decoder goes on with the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Its distances or its CRC-32 are wrong, or it is too short.
    #[error("a frame was damaged on the line and is skipped")]
    Damaged,
    /// It is longer than any frame of this version: its zero was damaged, or it is of another version.
    #[error("a frame is longer than {MAX_FRAME} bytes and is skipped")]
    Oversize,
    /// It is whole, but of another version of the protocol.
    #[error("a frame is of protocol version {0}, not {PROTOCOL_VERSION}: use host tool and firmware of one release")]
    Version(u8),
    /// It is whole, but its topic is not known here.
    #[error("a frame has the unknown topic {0}: host tool or firmware is the newer one; it is skipped")]
    Topic(u8),
    /// It is whole and its topic known, but not its body's form.
    #[error("a frame of topic {0} has a body of another schema: use host tool and firmware of one release")]
    Body(u8),
    /// It is a whole request with this number, but its command is not known here: refuse it.
    #[error("request {0} has an unknown command: use host tool and firmware of one release")]
    Request(u32),
}

/// What has been received, in frames. Every count stays at its largest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Frames that gave a message.
    pub received: u32,
    /// Runs of bytes between two zeros that are no whole frame.
    pub damaged: u32,
    /// Frames that the other side numbered and that never came whole: damaged, or not sent.
    ///
    /// A gap of up to 32 767 frames is counted; where the number went back instead, nothing is. Where it went back by up
    /// to 256, a piece of the stream has come twice, and what follows is counted from its end. Numbers start anew at each
    /// boot: a [`Hello`](crate::Hello) of another boot takes back what was counted since the `Hello` before it.
    pub lost: u32,
    /// Whole frames of another version.
    pub foreign: u32,
    /// Whole frames of this version whose topic or body is not known here.
    pub unknown: u32,
}

/// Frames that the number may go back by without a restart.
const REPEATED: u16 = 256;

/// Finds frames in a stream of bytes: of [`Message`](crate::Message)s on the host, of [`Request`](crate::Request)s on the
/// board.
///
/// After noise, cuts and insertions it goes on behind the next zero. Where it joins a stream in the middle of a frame,
/// the rest of that frame counts as damaged. See the [crate's example](crate).
#[derive(Debug)]
pub struct Decoder<P> {
    /// The bytes since the last zero.
    block: Vec<u8, { MAX_FRAME - 1 }>,
    oversize: bool,
    /// Number of the next frame, from the first frame on.
    next: Option<u16>,
    /// Boot number of the last `Hello`.
    boot: Option<u32>,
    lost_before_hello: u32,
    counts: Counts,
    payload: PhantomData<P>,
}

impl<P: Payload> Decoder<P> {
    /// A decoder at the start of a stream.
    #[must_use]
    pub const fn new() -> Self {
        let counts = Counts { received: 0, damaged: 0, lost: 0, foreign: 0, unknown: 0 };
        Self {
            block: Vec::new(),
            oversize: false,
            next: None,
            boot: None,
            lost_before_hello: 0,
            counts,
            payload: PhantomData,
        }
    }

    /// What has been received so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes one byte; says what the frame was that it ends.
    pub fn push(&mut self, byte: u8) -> Option<Result<P, DecodeError>> {
        if byte != 0 {
            self.oversize |= self.block.push(byte).is_err();
            return None;
        }
        if self.block.is_empty() {
            return None;
        }
        let payload = self.end_of_block();
        let count = match payload {
            Ok(_) => &mut self.counts.received,
            Err(DecodeError::Damaged | DecodeError::Oversize) => &mut self.counts.damaged,
            Err(DecodeError::Version(_)) => &mut self.counts.foreign,
            Err(DecodeError::Topic(_) | DecodeError::Body(_) | DecodeError::Request(_)) => &mut self.counts.unknown,
        };
        *count = count.saturating_add(1);
        self.block.clear();
        self.oversize = false;
        Some(payload)
    }

    fn end_of_block(&mut self) -> Result<P, DecodeError> {
        if self.oversize {
            return Err(DecodeError::Oversize);
        }
        let frame = Frame::open(&mut self.block)?;
        let payload = P::read(frame.topic, frame.body);
        let sequence = frame.sequence;
        self.count_lost(sequence);
        if let Some(boot) = payload.as_ref().ok().and_then(P::boot) {
            self.count_boot(boot, sequence);
        }
        payload
    }

    fn count_lost(&mut self, sequence: u16) {
        let gap = sequence.wrapping_sub(self.next.unwrap_or(sequence));
        if gap.wrapping_neg() <= REPEATED && gap != 0 {
            return;
        }
        if i16::try_from(gap).is_ok() {
            self.counts.lost = self.counts.lost.saturating_add(gap.into());
        }
        self.next = Some(sequence.wrapping_add(1));
    }

    fn count_boot(&mut self, boot: u32, sequence: u16) {
        if self.boot.is_some_and(|before| before != boot) {
            self.counts.lost = self.lost_before_hello;
            self.next = Some(sequence.wrapping_add(1));
        }
        self.boot = Some(boot);
        self.lost_before_hello = self.counts.lost;
    }
}

impl<P: Payload> Default for Decoder<P> {
    fn default() -> Self {
        Self::new()
    }
}
