//! The link's events as messages, for all clients.

use std::convert::Infallible;
use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use calibration_tables::ArmFile;
use proprio_link::{EventKind, LinkEvent, Subscription};
use proprio_session::recording::{BoardMessages, Channel, MessageInfo, MessageSink};
use telemetry::{Message, TICK_HZ};

use crate::channels::{self, ARM, TRANSFORMS};
use crate::scene::Scene;
use crate::stream::{Stream, StreamMessage};

/// Time for which events are gathered, two ticks of the board: each wake-up costs more than the work on a message.
const PERIOD: Duration = Duration::from_millis(20);
/// The same while there is no client.
const IDLE_PERIOD: Duration = Duration::from_millis(50);

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
        Self { board: BoardMessages::new(), scene: Scene::new(table), sink: StreamSink { stream, batch: Vec::new() } }
    }

    /// Works until `stop` is set.
    pub fn run(mut self, events: &Subscription, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(if self.sink.stream.has_clients() { PERIOD } else { IDLE_PERIOD });
            while let Some(event) = events.next(Duration::ZERO) {
                self.take(&event);
            }
            self.sink.stream.send(mem::take(&mut self.sink.batch));
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
struct StreamSink {
    stream: Arc<Stream>,
    /// Messages since the last batch was sent.
    batch: Vec<StreamMessage>,
}

impl MessageSink for StreamSink {
    type Error = Infallible;

    fn message(
        &mut self,
        channel: &'static Channel,
        info: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> Result<(), Infallible> {
        if let Some(channel) = channels::number(channel).filter(|channel| self.stream.is_received(*channel)) {
            self.batch.push(StreamMessage { channel, at: info.at, data: encode() });
        }
        Ok(())
    }
}
