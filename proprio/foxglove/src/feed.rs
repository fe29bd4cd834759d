//! The link's events as messages, for all clients.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use calibration_tables::ArmFile;
use proprio_link::{EventKind, LinkEvent, Subscription};
use proprio_session::recording::{BoardMessages, Channel, MessageInfo, MessageSink};
use telemetry::{Message, TICK_HZ};

use crate::channels::{self, ARM, TRANSFORMS};
use crate::scene::Scene;
use crate::stream::{Stream, StreamMessage};

/// Longest time between two checks for the end.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// Pictures of the arm per second; all else comes with every tick.
const PICTURES_HZ: f64 = 25.0;

/// State of the thread.
pub struct Feed {
    board: BoardMessages,
    scene: Scene,
    sink: StreamSink,
}

impl Feed {
    pub fn new(stream: Arc<Stream>, table: Option<&ArmFile>) -> Self {
        Self { board: BoardMessages::new(), scene: Scene::new(table), sink: StreamSink(stream) }
    }

    /// Works until `stop` is set.
    pub fn run(mut self, events: &Subscription, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            if let Some(event) = events.next(CHECK_PERIOD) {
                self.take(&event);
            }
        }
    }

    fn take(&mut self, LinkEvent { at, kind, .. }: &LinkEvent) {
        let message = match kind {
            EventKind::Message(message) => message,
            EventKind::Restarted | EventKind::Lost(_) => return self.scene.forget(),
            _ => return,
        };
        let Ok(()) = self.board.message(*at, message, &mut self.sink);
        self.scene.take(message);
        let Message::Estimate(estimate) = message else { return };
        let info = self.board.info(estimate.tick, *at);
        let Ok(()) = self.sink.message(&TRANSFORMS, info, || Scene::transforms(info.stamp, estimate));
        if estimate.tick.is_multiple_of((TICK_HZ / PICTURES_HZ) as u32) {
            let Ok(()) = self.sink.message(&ARM, info, || self.scene.arm(info.stamp, estimate));
        }
    }
}

/// The stream as a destination of messages.
struct StreamSink(Arc<Stream>);

impl MessageSink for StreamSink {
    type Error = Infallible;

    fn message(
        &mut self,
        channel: &'static Channel,
        info: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> Result<(), Infallible> {
        if let Some(channel) = channels::number(channel).filter(|channel| self.0.is_received(*channel)) {
            self.0.send(StreamMessage { channel, at: info.at, data: encode().into() });
        }
        Ok(())
    }
}
