//! The link's events as messages: those of a recording's channels, and two for 3D panels.

use calibration_tables::ArmFile;
use proprio_link::{EventKind, LinkEvent};
use proprio_session::recording::{BoardMessages, MessageSink};
use telemetry::{Message, TICK_HZ};

use crate::channels::{ARM, TRANSFORMS};
use crate::scene::Scene;

/// Pictures of the arm per second; all else comes with every tick.
const PICTURES_HZ: f64 = 25.0;

/// State between the events of a live arm: its board and its picture.
pub struct LiveMessages {
    board: BoardMessages,
    scene: Scene,
}

impl LiveMessages {
    /// Before a link's first event. `table` has the geometry of the arm; without it connectors are drawn as parts of the arcs.
    #[must_use]
    pub fn new(table: Option<&ArmFile>) -> Self {
        Self { board: BoardMessages::new(), scene: Scene::new(table) }
    }

    /// Passes the messages of an event to the channels that have them.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn take<S: MessageSink>(
        &mut self,
        LinkEvent { at, kind, .. }: &LinkEvent,
        sink: &mut S,
    ) -> Result<(), S::Error> {
        let message = match kind {
            EventKind::Message(message) => message,
            EventKind::Restarted | EventKind::Lost(_) => {
                self.scene.forget();
                return Ok(());
            }
            _ => return Ok(()),
        };
        self.board.message(*at, message, sink)?;
        self.scene.take(message);
        let Message::Estimate(estimate) = message else { return Ok(()) };
        let info = self.board.info(estimate.tick, *at);
        sink.message(&TRANSFORMS, info, || Scene::transforms(info.stamp, estimate))?;
        if estimate.tick.is_multiple_of((TICK_HZ / PICTURES_HZ) as u32) {
            sink.message(&ARM, info, || self.scene.arm(info.stamp, estimate))?;
        }
        Ok(())
    }
}
