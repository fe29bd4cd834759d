//! The other ends of the serial ports.

use sam3x_models::model::{Cycles, Reception};
use std::collections::VecDeque;

/// Bytes that a port has sent, and bytes on their way to it.
#[derive(Debug, Clone, Default)]
pub struct Port {
    transmitted: Vec<(Cycles, u8)>,
    /// Bytes to be sent, each not before a time.
    queue: VecDeque<(Cycles, u8)>,
    /// Time at which the first of the queue is complete; `None` until the port first polls.
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

    /// Takes a byte that is complete. A byte begins at its time or when the one before it is complete, and takes `byte_time`.
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
    fn bytes_arrive_one_byte_time_apart_however_late_the_port_polls() {
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
