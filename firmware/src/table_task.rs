//! Table task: stores, reads and erases the table in the flash. It has the lowest priority, as a page takes milliseconds.

use atsam3x8e_hal::eefc::Flash;
use board_core::{TableAnswer, TableServer};
use rtic::Mutex;
use telemetry::{Message, Reply, Request, RequestOutcome};

use crate::command_task::Control;
use crate::downlink::TelemetrySender;

/// State of the table task.
pub struct TableTask {
    server: TableServer<Flash>,
}

impl TableTask {
    /// The task for the table's server.
    pub const fn new(server: TableServer<Flash>) -> Self {
        Self { server }
    }

    /// Executes a request about the table and replies. Returns whether the board must restart, with another table.
    pub fn run(
        &mut self,
        request: &Request,
        mut control: impl Mutex<T = Control>,
        mut sender: impl Mutex<T = TelemetrySender>,
    ) -> bool {
        let result = self.server.execute(&request.command);
        let outcome = result.as_ref().map_or_else(|refusal| RequestOutcome::Nack(*refusal), |_| RequestOutcome::Ack);
        let reply = Reply { id: request.id, session: request.session, outcome };
        control.lock(|control| control.completed = Some(reply));
        sender.lock(|sender| {
            sender.send(&Message::Reply(reply));
            if let Ok(TableAnswer { message: Some(message), .. }) = &result {
                sender.send(message);
            }
        });
        match result {
            Ok(TableAnswer { restart, .. }) => restart,
            Err(refusal) => {
                defmt::warn!("request {} refused: {}", request.id, refusal);
                false
            }
        }
    }
}
