//! The far ends of the serial ports.

use sam3x_models::model::{Cycles, Reception};
use std::collections::VecDeque;

/// What has come from a port and what is on its way to it.
#[derive(Debug, Clone, Default)]
pub struct Port {
    transmitted: Vec<(Cycles, u8)>,
    /// Bytes to be sent, each not before a time.
    queue: VecDeque<(Cycles, u8)>,
    /// When the first of the queue is complete; none before the port first asked for it.
    due: Option<Cycles>,
}

impl Port {
    pub fn note_transmitted(&mut self, byte: u8, now: Cycles) {
        self.transmitted.push((now, byte));
    }

    pub fn take_transmitted(&mut self) -> Vec<(Cycles, u8)> {
        std::mem::take(&mut self.transmitted)
    }

    pub fn send(&mut self, bytes: &[u8], not_before: Cycles) {
        self.queue.extend(bytes.iter().map(|byte| (not_before, *byte)));
    }

    /// A byte begins when its time has come and the one before it is complete, and takes `byte_time`.
    pub fn receive(&mut self, byte_time: Cycles, now: Cycles) -> Reception {
        let Some((not_before, byte)) = self.queue.front().copied() else { return Reception::Idle };
        let due = *self.due.get_or_insert(not_before.max(now) + byte_time);
        if due > now {
            return Reception::At(due);
        }
        self.queue.pop_front();
        self.due = self.queue.front().map(|(not_before, _)| due.max(*not_before) + byte_time);
        Reception::Byte(byte)
    }
}

#[cfg(test)]
mod tests {
    use super::{Port, Reception};

    #[test]
    fn bytes_come_one_byte_time_apart_however_late_one_asks() {
        let mut port = Port::default();
        assert_eq!(port.receive(10, 0), Reception::Idle);
        port.send(b"ab", 100);
        assert_eq!(port.receive(10, 50), Reception::At(110));
        assert_eq!(port.receive(10, 112), Reception::Byte(b'a'));
        assert_eq!(port.receive(10, 112), Reception::At(120));
        assert_eq!(port.receive(10, 120), Reception::Byte(b'b'));
        assert_eq!(port.receive(10, 120), Reception::Idle);
    }
}
