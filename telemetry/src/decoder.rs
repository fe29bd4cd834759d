//! Decoder: bytes in pieces of any length in, messages out.

use core::marker::PhantomData;

use heapless::Vec;

use crate::constants::MAX_FRAME;
use crate::decode_error::DecodeError;
use crate::frame::Frame;
use crate::payload::Payload;

/// Counts of received frames. Each saturates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Frames that gave a message.
    pub received: u32,
    /// Runs of bytes between two zeros that are no valid frame.
    pub damaged: u32,
    /// Frames that the sender numbered and that never arrived whole: damaged, or dropped before transmission.
    ///
    /// A gap of up to 32 767 sequence numbers is counted, a step back is not. After a step back of up to 256 a piece of the
    /// stream was received twice, and counting resumes at its end. Sequence numbers restart at each boot: a
    /// [`Hello`](crate::Hello) of another boot discards the count since the previous `Hello`.
    pub lost: u32,
    /// Valid frames of another version.
    pub wrong_version: u32,
    /// Valid frames of this version with an unknown topic or body.
    pub unknown: u32,
}

/// Largest step back of the sequence number without a restart, frames.
const REPEATED: u16 = 256;

/// Finds frames in a stream of bytes: of [`Message`](crate::Message)s on the host, of [`Request`](crate::Request)s on the
/// board.
///
/// After noise, cuts and insertions it resynchronises at the next zero. If it joins a stream in the middle of a frame,
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
    /// Version of the last frame that could be read.
    version: Option<u8>,
    counts: Counts,
    payload: PhantomData<P>,
}

impl<P: Payload> Decoder<P> {
    /// A decoder at the start of a stream.
    #[must_use]
    pub const fn new() -> Self {
        let counts = Counts { received: 0, damaged: 0, lost: 0, wrong_version: 0, unknown: 0 };
        Self {
            block: Vec::new(),
            oversize: false,
            next: None,
            boot: None,
            lost_before_hello: 0,
            version: None,
            counts,
            payload: PhantomData,
        }
    }

    /// Counts of received frames so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Version of the protocol in the last frame of one that is read: the sender's.
    #[must_use]
    pub const fn version(&self) -> Option<u8> {
        self.version
    }

    /// Decodes one byte; returns the payload or the error of the frame that it ends, if it ends one.
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
            Err(DecodeError::Version(_)) => &mut self.counts.wrong_version,
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
        let frame = Frame::open(&mut self.block, P::VERSIONS)?;
        self.version = Some(frame.version);
        let payload = P::read(frame.version, frame.topic, frame.body);
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
