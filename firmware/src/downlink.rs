//! Telemetry to the host: messages become frames, which wait for the line or are dropped whole.

use atsam3x8e_hal::uart::Tx;
use telemetry::{Encoder, MAX_FRAME, Message};

/// Sender of messages.
pub struct TelemetrySender {
    tx: Tx,
    encoder: Encoder,
    dropped: u32,
}

impl TelemetrySender {
    /// Sends a zero, which ends a frame that a reset may have cut short.
    pub fn new(mut tx: Tx) -> Self {
        // The transmit buffer is empty now.
        let _ = tx.try_write_frame(&[0]);
        Self { tx, encoder: Encoder::new(), dropped: 0 }
    }

    /// Sends a message, or counts it as dropped if the transmit buffer is full. It takes a sequence number in both cases,
    /// so that the host counts it too.
    pub fn send(&mut self, message: &Message) {
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(message, &mut buffer);
        if frame.is_ok_and(|frame| self.tx.try_write_frame(frame).is_ok()) {
            return;
        }
        self.dropped = self.dropped.saturating_add(1);
    }

    /// Frames since boot that were dropped.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}
