//! What the board says: messages become frames, and frames wait for the line or are dropped whole.

use atsam3x8e_hal::uart::Tx;
use telemetry::{Encoder, MAX_FRAME, Message};

/// The sending side of the line.
pub struct Voice {
    tx: Tx,
    encoder: Encoder,
    dropped: u32,
}

impl Voice {
    /// Nothing is said yet but a zero, which ends the frame that a reset may have cut short.
    pub fn new(mut tx: Tx) -> Self {
        // The line is empty now.
        let _ = tx.try_write_frame(&[0]);
        Self { tx, encoder: Encoder::new(), dropped: 0 }
    }

    /// Says it, or counts it as dropped if the line is full. The numbers of frames go on, so that the host counts too.
    pub fn say(&mut self, message: &Message) {
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(message, &mut buffer);
        if frame.is_ok_and(|frame| self.tx.try_write_frame(frame).is_ok()) {
            return;
        }
        self.dropped = self.dropped.saturating_add(1);
    }

    /// Frames since boot that found the line full.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}
